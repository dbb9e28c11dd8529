"""One least-squares fit of the whole shot, through the simulator.

`observed` turns a local fit (`curlshot.physics.local_fit`) into a `shot_model.ObservedShot`:
detections, the order of the hits, first guesses and priors. `shot_model` is the model: from
unknowns to residuals. `global_fit` fits it; the result is a `result.ShotFit`. `model_selection`
chooses the law of the ice and whether the fit includes curl. `valid_interval` shortens a shot to
the interval that the simulator reproduces. `off_centre` estimates how far caps lie from the
centres of their stones.
"""
