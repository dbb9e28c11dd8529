"""The painted sheet in one picture: circles and lines found, measured and fitted.

`house` finds the house, whatever its colours: `rings` guesses where concentric rings are, in a
picture seen from above or made so (`tilt`), `house_fit` fits a camera to a guess with the `lines`,
and `proof` asks whether it is a house. Edges are measured at `stations` along the paint, on their
`normals`: `marks` does it with `edges` (of two colours), `outline` and `outlined` (dark outlines)
and `stripes` (lines), `runs` strikes off what lies aside, and `mixing` takes out the bias of blur.
"""
