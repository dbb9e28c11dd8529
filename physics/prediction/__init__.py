"""Simulations of the measured shot: the replay, the prediction, and what if.

`start` holds the states before the first hit, `laws` the measured or assumed laws of ice and hits.
`replay` simulates with the fitted laws, `forecast` with what was known before the first hit.
`fitted_shot` draws from the fit. `uncertainty` computes the standard errors of a simulated shot.
`what_if` changes the shot.
"""
