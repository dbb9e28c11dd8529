"""One least-squares fit of the whole shot, through the simulator.

`watched` turns a fit of pieces (`curlshot.physics.local_fit`) into a `shot_model.Watched`:
detections, the order of the hits, first guesses and priors. `shot_model` is the model: from
unknowns to residuals. `global_fit` fits it; the result is a `whole_fit.GlobalFit`. `law_choice`
chooses the law of the ice and whether curl shows, `followed` shortens a shot to what the simulator
can follow, and `off_centre` has the caps that lie beside the centres of their stones.
"""
