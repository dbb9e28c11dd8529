"""Reading clips: frames in order, each of one moment, at its true time.

`reader` has the one object that a clip is read by, `Video`. Its `source` decodes the frames of a
video's file, of pictures, or of a Tracker project (`project_steps`). `deinterlace` makes frames of
one moment from fields, `letterbox` finds black bars, `duplicates` finds frames that repeat the one
before, and `telecine` finds when the others were taken if the clip was converted between frame
rates. A `frame` has its `picture` in the decoder's own planes; `colour` turns colours into L*a*b*,
and `flow` is the motion of the whole picture. `disk_cache` keeps on disk what a long clip has much
of.
"""
