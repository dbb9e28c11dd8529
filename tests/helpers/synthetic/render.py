"""What tests of render share."""

from __future__ import annotations

from dataclasses import replace

from curlshot.synthetic import (
    Light,
    Paint,
    Scene,
    Sheet,
    Start,
    red_stone,
)

CLEAN = Light(glare=0, vignette=0, softness=0, noise=0, texture=0)
BARE = Scene(paint=Paint(outline=None, logo=""), sheet=Sheet(marks=()), light=CLEAN)


def lone_stone(start: Start) -> Scene:
    stone = replace(red_stone("A", start), handle=(44, 26, 178))
    sheet = Sheet(marks=(), line=BARE.sheet.ice)
    plain = Paint(*(BARE.sheet.ice,) * 4, outline=None, logo="")
    return replace(BARE, stones=(stone,), paint=plain, sheet=sheet, light=replace(CLEAN, lamps=()))
