"""Stones in pictures: sought, measured on rays, and placed on the ice.

In the order of the work:

`ice_map` rectifies a picture and `seek` finds places on it that answer to a template. About each
place `patch` and `rays` sample the picture itself, and `measure` tells what is there: `samples`
says what is cap and what granite (`appearance` has the colours learned from the clip, `contrast`
those of one stone), `rims` finds edges on the rays, `circles` fits circles to them, `edges` puts
together what sets them aside, and `evidence` weighs whether it is a stone. `stones` does all that
for one picture, says why a place was refused, and has `placing` take the cap's height out. The
result is a `detection.Detection`.

Of no stone anything is known at first: `strangers` finds them by their shape, `shape` how large
their caps are, `relief` whether they have handles. `balance` makes pictures of one light, `hue`
undoes what coding has blurred. Where a cap ends is told by a model of its own where it is grey
(`mixture`) or its granite is hidden (`shoulder`), and where the middle of one in motion is by
`smeared`. `roundness` and `steady` are about errors that the pictures of one stone share. `glance`
looks at single pictures for ``curlshot check``.
"""
