"""The measured shot simulated: as it was fitted, as it would have been predicted, and what if.

`start` has the states before the first hit and `laws` what is known or assumed of ice and hits.
`hindcast` simulates with what the whole shot tells, `forecast` with what was known before its first
hit, `as_fitted` draws from the fit; `spread` gives the standard errors of a simulated shot, and
`what_if` changes it.
"""
