from __future__ import annotations

import argparse
from pathlib import Path

import pytest

from curlshot.cli import values
from curlshot.data.limits import FRACTION, FRICTION, OFFSET, POSITIVE, RADIUS, SAMPLES
from curlshot.physics.prediction.what_if import Amount


@pytest.mark.parametrize(
    ("read", "text", "value"),
    [
        (values.within(POSITIVE), "0.5", 0.5),
        (values.folder, "shot", Path("shot")),
        (values.within(FRACTION), "1", 1.0),
        (values.within(FRICTION), "0.0109", 0.0109),
        (values.within(OFFSET), "-0.05", -0.05),
        (values.amount, "1.5", Amount(1.5, False)),
        (values.amount, "-0.5x", Amount(-0.5, True)),
        (values.speed, "1.1x", Amount(1.1, True)),
        (values.whole(SAMPLES), "0", 0),
        (values.throw_sd, "0.0076,0.0018", (0.0076, 0.0018)),
        (values.frame_range, "2:31", (2, 31)),
        (values.frame_range, "10:", (10, None)),
        (values.frame_range, ":5", (0, 5)),
        (values.stick, "20,36,20,220,0.5", (20.0, 36.0, 20.0, 220.0, 0.5)),
        (values.house, "0:640,360,460,360,640,180", (0, 640, 360, 460, 360, 640, 180)),
        (values.house, "640,360,460,360,640,180", (None, 640, 360, 460, 360, 640, 180)),
        (values.mass, "a=b=19.1", ("a=b", 19.1)),
        (values.pair, "A=mass A", ("A", "mass A")),
    ],
)
def test_what_is_meant_is_read(read, text: str, value) -> None:
    assert read(text) == value


@pytest.mark.parametrize(
    ("read", "text", "said"),
    [
        (values.within(POSITIVE), "-1", "not a positive number"),
        (values.within(POSITIVE), "inf", "not a positive number"),
        (values.folder, "", "not the name of a folder"),
        (values.within(FRACTION), "1.2", "a number from 0 to 1"),
        (values.within(FRICTION), "0.5", "a friction of ice"),
        (values.within(RADIUS), "14.55", "a radius in metres"),
        (values.within(RADIUS), "-1", "a radius in metres"),
        (values.within(OFFSET), "far", "a distance in metres"),
        (values.within(OFFSET), "-0,05", r"-5 to 5; write -0\.05, with a point"),
        (values.speed, "1,1x", r"at most 10x; write 1\.1x, with a point"),
        (values.mass, "A=19,1", r"a positive number; write 19\.1, with a point"),
        (values.speed, "0", "nor a factor such as 1.1x"),
        (values.speed, "11x", "at most 10x"),
        (values.whole(SAMPLES), "-1", "a number of samples"),
        (values.whole(SAMPLES), "1e3", "a number of samples"),
        (values.whole(SAMPLES), "100001", "a number of samples"),
        (values.throw_sd, "0.1", "not V,A"),
        (values.throw_sd, "0.1,2", "a standard deviation in rad"),
        (values.frame_range, "5", "not FIRST:LAST"),
        (values.stick, "1,2,3,4", "not X1,Y1,X2,Y2,METRES"),
        (values.stick, "20,36,20,220,0,5", r"METRES, e\.g\. 20,36,20,220,0\.5"),
        (values.stick, "1,2,1,2,3", "the stick has no length"),
        (values.stick, "1,2,3,4,-5", "the stick has no length"),
        (values.house, "a:1,2,3,4,5,6", "not FRAME:XC"),
        (values.mass, "19.1", "not STONE=MASS"),
        (values.pair, "A=", "not STONE="),
    ],
)
def test_what_makes_no_sense_is_refused_with_what_was_expected(read, text: str, said: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=said):
        read(text)
