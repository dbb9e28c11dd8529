from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from curlshot.config import Config, refuse_table_settings
from curlshot.data.errors import InputError


def test_a_tab_is_refused_where_nothing_has_tabs() -> None:
    with pytest.raises(InputError, match="only tables take `tab`, `length_unit`"):
        refuse_table_settings(Path("shot.mp4"), Config().replace(tab="a", length_unit="cm"))
    with pytest.raises(InputError, match="only tables take `names`"):
        refuse_table_settings(Path("shot.trz"), Config().replace(names={"A": "mass A"}, tab="a"))


def test_a_project_has_tabs_as_a_clip_and_as_a_camera() -> None:
    refuse_table_settings(Path("shot.trz"), Config().replace(tab="a"))
    refuse_table_settings(
        Path("shot.mp4"), Config().replace(tab="a", length_unit="cm", camera=Path("shot.trk"))
    )


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ({"radius": -1.0}, "radius: -1.0 is not a radius in metres, 0.001 to 1"),
        ({"radius": float("nan")}, "radius: nan is not a radius in metres"),
        ({"restitution": 3.0}, "restitution: 3.0 is not a number from 0 to 1"),
        ({"friction": 0.5}, "friction: 0.5 is not a friction of ice"),
        ({"samples": -4}, "samples: -4 is not a number of samples, 0 to 100000"),
        ({"masses": {"A": 0.0}}, "mass of A: 0.0 is not a positive number"),
        ({"fps": float("inf")}, "fps: inf is not a positive number"),
        ({"stick": (1.0, 2.0, 1.0, 2.0, 0.5)}, "has no length"),
        ({"camera_height": 0.5}, "camera_height: 0.5 is not a height in metres, 1 to 100"),
        ({"camera_height": 5.0, "camera": "c.csv"}, "`camera_height` is of a camera found by its"),
        ({"length_unit": "furlong"}, "length_unit 'furlong': one of m, cm"),
        ({"angle_unit": "turn"}, "angle_unit 'turn': one of rad, deg"),
        ({"units": "yd"}, "units 'yd': one of m, ft"),
        ({"samples": 2.5}, "samples: 2.5 is not a number of samples"),
        ({"radius": "0.1"}, "radius: '0.1' is not a radius"),
        ({"fps": "25"}, "fps: '25' is not a positive number"),
        ({"fps": True}, "fps: True is not a positive number"),
        ({"length_unit": ["m"]}, r"length_unit \['m'\]: one of m, cm"),
        ({"samples": None}, "samples: None is not a number of samples"),
        ({"camera": 5}, "camera: 5 is not a path"),
        ({"angles": {"A": 5}}, "angles of A: 5 is not a path"),
        ({"names": {"A": 5}}, "track of A: 5 is not a text"),
        ({"tab": 1}, "tab: 1 is not a text"),
        ({"no_house": "yes"}, "no_house: 'yes' is not True or False"),
        ({"masses": [1, 2]}, "masses: by stone, please"),
        ({"names": ["A"]}, "names: by stone, please"),
        ({"stick": (1.0, 2.0, 3.0, 4.0)}, "stick .*: 5 values, please"),
        ({"stick": "1,2,3"}, "stick '1,2,3': 5 values, please"),
        ({"frames": (0.5, 30)}, "frames: 0.5 is not a number of a frame"),
        ({"frames": (0, "end")}, "frames: 'end' is not a number of a frame"),
        ({"house": (0, 1, 2, 3, 4, 5, float("nan"))}, "house: nan is not a number"),
    ],
)
def test_what_the_command_refuses_is_refused_from_python(said: dict[str, Any], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        Config().replace(**said)


def test_paths_may_be_strings() -> None:
    settings = Config().replace(camera="camera.csv", angles={"A": "a.txt"})
    assert (settings.camera.camera, settings.tables.angles) == (
        Path("camera.csv"),
        {"A": Path("a.txt")},
    )
