"""Clips as a decoder gives them: pictures, their times, and what is put aside of them.

`clip` opens and reads them, frame by frame, each a `picture` in the decoder's own planes; `lab`
turns colours into L*a*b*. `repeats` knows duplicate frames, `cadence` when pictures were taken that
are told at another rate, `flow` the motion of the whole picture. `shelf` puts things on
disk, so that a long clip takes no more memory than a short one.
"""
