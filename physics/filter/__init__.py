"""The Kalman filter of one stone between two hits, and its process model.

`stretch` has the input and the process model: `slowing` is the known deceleration, `spin_end` tells
where a spin ends at once. `rate_filter` filters and smooths, and is tested against the same with
matrices. `physics.kalman` runs it over a shot.
"""
