"""The camera through a clip: the house followed from picture to picture.

`follow_house` follows it, or `given` where a person shows it. A clip is cut into pieces of one
camera (`piece`); `replay` tells which of them show the shot. From picture to picture `egomotion`
and, where that is too fast, `leap` tell about how the camera moved; `edge_tracker` then refines the
view on the edges of the house, and where no rings are in view `ice_tracker` does on `landmarks` and
lines, found with the help of earlier pictures (`keyframe`). `shutter` and `smear` know the blur of
a pan. `joint` makes one camera path of all that was measured (`curlshot.vision.optics.bundle`).
"""
