from __future__ import annotations

from pathlib import Path

import pytest

from curlshot.data.errors import InputError
from curlshot.physics.curl import FCV1Curl, NoCurl
from curlshot.physics.ice import FCV1, Constant, Penner
from curlshot.physics.impact import Frictional, PointMass, RigidBody
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.shot import read_shot
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot, StoneStart
from curlshot.tests.helpers.physics.shot import read

WHOLE = """
[physics]
model = "frictional"
restitution = 0.9
stone_friction = 0.3
ice = "constant"
friction = 0.0120
curl = "none"
radius = 0.1455
inertia = 0.45
[[stone]]
name = "A"
x = 0.1
y = -3
vx = 0.01
vy = 2.4
omega = 1.5708
theta = 0.2
mass = 18.5
[[stone]]
name = "B"
x = 0.0
y = 0.0
omega_after = [1.5, -0.25]
"""
ONE_STONE = '[[stone]]\nname = "A"\nx = 0\ny = 0\n'


def test_every_key_is_read(tmp_path: Path) -> None:
    assert read(tmp_path, WHOLE) == Shot(
        stones=(
            StoneStart("A", 0.1, -3.0, 0.01, 2.4, 1.5708, 0.2, mass=18.5),
            StoneStart("B", 0.0, 0.0, omega_after=(1.5, -0.25)),
        ),
        impact=Frictional(0.9, 0.3, 0.45),
        ice=Constant(0.012),
        curl=NoCurl(),
        radius=0.1455,
    )


def test_all_of_physics_is_optional(tmp_path: Path) -> None:
    shot = read(tmp_path, ONE_STONE)
    assert shot == Shot(
        (StoneStart("A", 0.0, 0.0),), Frictional(1.0, 0.2, 0.5), FCV1(), FCV1Curl(), 0.145
    )
    assert simulate(shot).rest["A"].t == 0


@pytest.mark.parametrize(
    ("laws", "field", "value"),
    [
        ('model = "point-mass"\nrestitution = 0.8', "impact", PointMass(0.8)),
        ('model = "rigid-body"\nrestitution = 0.8', "impact", RigidBody(0.8)),
        ('ice = "constant"', "ice", Constant(0.0109)),
        ('ice = "penner"', "ice", Penner()),
        ('ice = "penner"\nfriction = 0.007', "ice", Penner(0.007)),
        ("radius = 1", "radius", 1.0),
    ],
)
def test_laws(tmp_path: Path, laws: str, field: str, value: object) -> None:
    assert getattr(read(tmp_path, f"[physics]\n{laws}\n{ONE_STONE}"), field) == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no stone: add a table"),
        ("[physics]\nradius = 0.1", "no stone: add a table"),
        ("x =", "not TOML"),
        ("x = 1\nx = 2", "not TOML"),
        ("x = 1\nvy = -2,4\n", "at line 2, column 8): “vy = -2,4”"),
        ("[stone]\nname = 'A'", "must be tables, [[stone]]"),
        ("physics = 1\n" + ONE_STONE, "must be a table, [physics]"),
        ("[phisics]\n" + ONE_STONE, "unknown key phisics (did you mean physics?)"),
        ("[physics]\nrestitutoin = 1\n" + ONE_STONE, "restitutoin (did you mean restitution?)"),
        ("[physics]\nrestitution = 1.2\n" + ONE_STONE, "restitution = 1.2 must be within 0..1"),
        ("[physics]\nrestitution = true\n" + ONE_STONE, "restitution must be a number"),
        ("[physics]\nstone_friction = -1\n" + ONE_STONE, "stone_friction = -1 must be at least 0"),
        ("[physics]\ninertia = 0\n" + ONE_STONE, "inertia = 0 must be above 0"),
        ("[physics]\nradius = -0.1\n" + ONE_STONE, "radius = -0.1 must be above 0"),
        ("[physics]\nradius = 14.5\n" + ONE_STONE, "radius = 14.5 must be above 0, 1 at most"),
        ("[physics]\nmodel = 'friction'\n" + ONE_STONE, "did you mean frictional?"),
        ("[physics]\nice = 'snow'\n" + ONE_STONE, "there are constant, fcv1, fit, penner"),
        ("[physics]\nice = 3\n" + ONE_STONE, "no ice 3"),
        ("[physics]\ncurl = 'fcv2'\n" + ONE_STONE, "did you mean fcv1?"),
        ("[physics]\nfriction = 0.01\n" + ONE_STONE, 'friction is for ice = "constant"'),
        (
            "[physics]\nice = 'penner'\nfriction = 0\n" + ONE_STONE,
            "friction = 0 must be within 0.0001..1",
        ),
        ("[[stone]]\nx = 0\ny = 0", "stone number 1: name is missing"),
        ("[[stone]]\nname = 7\nx = 0\ny = 0", "stone number 1: name is missing or no text"),
        ("[[stone]]\nname = 'A'\ny = 0", "stone A: x is missing"),
        ("[[stone]]\nname = 'A'\nx = nan\ny = 0", "stone A: x = nan is not finite"),
        ("[[stone]]\nname = 'A'\nx = 0\ny = -inf", "stone A: y = -inf is not finite"),
        (ONE_STONE + "vx = 1" + "0" * 400, "stone A: vx = 100000000000 is not finite"),
        (ONE_STONE + "vx = 1e9", "stone A: vx = 1e+09 must be within -100..100"),
        (ONE_STONE + "speed = 1", "stone A: unknown key speed"),
        (ONE_STONE + "omega_after = []", "omega_after is an empty list"),
        (ONE_STONE + "omega_after = [1, 'a']", "omega_after must be a number, not 'a'"),
        (ONE_STONE + ONE_STONE.replace("x = 0", "x = 1"), "two stones named A"),
        (
            ONE_STONE + "[[stone]]\nname = 'B'\nx = 0.25\ny = 0",
            "stones A and B overlap by 40 mm",
        ),
    ],
)
def test_a_mistake_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    line = str(caught.value)
    assert message in line
    assert line.startswith(str(tmp_path / "SHOT.toml"))
    assert "\n" not in line


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    text = "[physics]\nradius = 0\nmodle = 'x'\n[[stone]]\nname = 'A'\nx = 'left'\nvy = inf"
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    for part in ("radius", "modle", "x must be", "y is missing", "vy = inf"):
        assert part in str(caught.value)


def test_a_small_overlap_is_measuring(tmp_path: Path) -> None:
    shot = read(tmp_path, ONE_STONE + "[[stone]]\nname = 'B'\nx = 0.28\ny = 0")
    assert simulate(shot).hits == ()


def test_files_that_are_none(tmp_path: Path) -> None:
    for name in ("binary", "binary.toml"):
        (tmp_path / name).write_bytes(b"\xff\xfe\x00\x81")
    (tmp_path / "tracks.csv").write_text("stone,t,x,y\n")
    for name, message in (
        ("missing.toml", "No such file"),
        ("", "directory"),
        ("binary.toml", "not a text in UTF-8"),
        ("binary", "not a shot; name a SHOT.toml or the folder of a run"),
        ("tracks.csv", "not a shot; name a SHOT.toml or the folder of a run"),
    ):
        with pytest.raises(InputError, match=message):
            read_shot(tmp_path / name)


def test_the_sheet_is_chosen_by_its_way_of_play(tmp_path: Path) -> None:
    stone = '[[stone]]\nname = "A"\nx = 0\ny = 0\n'
    assert read(tmp_path, stone).bounds is None
    assert read(tmp_path, '[physics]\nsheet = "none"\n' + stone).bounds is None
    assert read(tmp_path, '[physics]\nsheet = "down"\n' + stone).bounds == Bounds(-1)
    with pytest.raises(InputError, match=r'sheet = "down" is for .* thrown down y, but A goes up'):
        read(tmp_path, '[physics]\nsheet = "down"\n' + stone + "vy = 2.0\n")
    with pytest.raises(InputError, match=r"no sheet 'upp' \(did you mean up\?\)"):
        read(tmp_path, '[physics]\nsheet = "upp"\n' + stone)


def test_a_file_of_a_windows_editor_is_read(tmp_path: Path) -> None:
    path = tmp_path / "SHOT.toml"
    path.write_bytes(b"\xef\xbb\xbf" + ONE_STONE.encode())
    assert len(read_shot(path).stones) == 1
