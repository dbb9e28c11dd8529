"""The Kalman filter of one stone between two hits, and its process model.

`stretch` has the input and the process model: `slowing` is the known deceleration, `spin_end` tells
where a spin ends at once. `rate_filter` filters and smooths; `reference_filter` does the same with
matrices, and is what the first is tested against. `curlshot.physics.kalman` runs them over a shot.
"""
