"""Cameras: views and lenses, fitted to marks, and the tables they come from and go to.

A `camera` is that of one frame, a row of ``camera.csv``: homography, lens and place; `cameras` are
those of many points at once, `projection` has the plain functions. When fitted, it is split into
what a frame has of its own, a `pose` (pan, tilt, roll, zoom), and what all frames share, a `rig`:
the place, the lens and the measures of the `paint`.

Fits: `resection` of one view from its marks, `adjust` of a few frames, `bundle` of a clip, whose
result is in `shared`; `linear` has residuals and derivatives, `robust` and `arrow` the algebra.
`predict` says where the next view will be, `quality` how good each is, `astray` what video coding
adds. Cameras that nobody fits come from a `stick`, from `camera_file` or from Tracker
(`project_clip`, `tracker_view`). `placed` is the callback for each frame.
"""
