"""The golden runs: inputs by name, and the commands that make an output of each.

Commands hold places for folders: ``{inputs}`` of all inputs, ``{out}`` of all outputs, and
``{shared}`` of third-party files beside the repository. Each case writes into ``{out}/NAME``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from curlshot.tests.golden.clips import CLIPS
from curlshot.tests.golden.tables import WRITERS

SHARED = Path(__file__).resolve().parents[3] / "shared"
SAMPLE = "sample"

SETTINGS: Mapping[str, Mapping[str, object]] = {
    "clip_frozen": {"camera_height": 9.0},
    "clip_oblique": {"frames": (2, 58)},
    "table_centimetres": {"length_unit": "cm"},
    "table_degrees": {"angle_unit": "deg"},
    "table_long_frames": {"fps": 25.0},
    "table_long": {"no_house": True, "masses": {"A": 19.1, "B": 18.6, "C": 19.4}},
    "table_tab_full": {"samples": 200, "restitution": 0.85, "friction": 0.011, "units": "ft"},
}
"""What is set of a case, by its name in the configuration."""

SHOTS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "frictional": (
        """
[physics]
model = "frictional"
restitution = 0.84
stone_friction = 0.1
sheet = "up"
[[stone]]
name = "A"
x = 0.1
y = -4.0
vx = 0.02
vy = 2.2
omega = 1.2
[[stone]]
name = "B"
x = 0.2
y = 0.3
[[stone]]
name = "C"
x = 0.45
y = 1.1
theta = 1.0
""",
        ("--samples", "200", "--fps", "10"),
    ),
    "rigid_body": (
        """
[physics]
model = "rigid-body"
restitution = 0.9
ice = "constant"
friction = 0.012
curl = "none"
[[stone]]
name = "A"
x = 0.0
y = -3.0
vx = 0.0
vy = 1.8
omega = 0.8
mass = 19.5
omega_after = [0.6]
[[stone]]
name = "B"
x = 0.1
y = 0.0
mass = 18.9
omega_after = [0.4]
""",
        (),
    ),
    "point_mass": (
        """
[physics]
model = "point-mass"
ice = "penner"
friction = 0.0125
[[stone]]
name = "A"
x = 0.0
y = -2.0
vx = 0.1
vy = 1.5
omega = -1.0
[[stone]]
name = "B"
x = 0.1
y = 0.5
""",
        ("--speed", "1.05x", "--aim-offset", "0.02", "--samples", "50"),
    ),
}
"""Shots as a person writes them, and the options they are simulated with."""

SHARED_TABLES = (
    "tracker/samples/full_export_default_frame.txt",
    "tracker/samples/step2_tablecopy_formatted.txt",
    "tracker/samples/step2_tablecopy_fullprecision.txt",
    "tracker/samples/svSE_tablecopy_formatted.txt",
    "tracker/samples/svSE_tablecopy_fullprecision.txt",
    "tracker/samples/tablecopy_formatted.txt",
    "tracker/samples/tablecopy_fullprecision.txt",
    "cases/05_side9.txt",
    "cases/12_drop1.csv",
    "cases/12_drop4.csv",
)
"""Tables of the second set in ``{shared}`` that tell of stones at speeds of curling."""

SHARED_CLIPS = (
    "12_dropvid.mp4",
    "15_stillfirst.mkv",
    "16_flipm.mp4",
    "18_dam.ts",
)
"""Clips of the second set in ``{shared}/cases``."""


@dataclass(frozen=True)
class Case:
    """Commands that make one output.

    Attributes
    ----------
    name : str
        Of the case and its folder.
    commands : tuple
        Words of each command after the program's name.
    needs : tuple of str
        Cases whose whole output folders the commands read.
    """

    name: str
    commands: tuple[tuple[str, ...], ...]
    needs: tuple[str, ...] = ()
    settings: Mapping[str, object] = field(default_factory=dict)


def options_of(settings: Mapping[str, object]) -> list[str]:
    """Return settings as options of the command line."""
    words: list[str] = []
    for name, value in settings.items():
        option = f"--{name.replace('_', '-')}"
        if isinstance(value, Mapping):
            for stone, mass in value.items():
                words += ["--mass", f"{stone}={mass}"]
        elif isinstance(value, tuple):
            words += [option, ":".join(map(str, value))]
        elif value is True:
            words.append(option)
        else:
            words += [option, str(value)]
    return words


def _run(name: str, *inputs: str, words: Sequence[str] = ()) -> Case:
    settings = SETTINGS.get(name, {})
    options = [*options_of(settings), *words]
    command = ("run", *inputs, "-o", f"{{out}}/{name}", "-q", "--no-overlay", *options)
    return Case(name, (command,), settings=settings)


def _simulate(name: str, shot: str, *options: str, needs: tuple[str, ...] = ()) -> Case:
    return Case(name, (("simulate", shot, "-o", f"{{out}}/{name}", "-q", *options),), needs)


def _read(path: str) -> Case:
    """Return a case that imports a table of ``{shared}``, and estimates from it if it can."""
    name = case_of(path)
    words: list[tuple[str, ...]] = [("convert", f"{{shared}}/{path}", f"{{out}}/{name}/tracks.csv")]
    if path in SHARED_TABLES:
        words.append(("estimate", f"{{shared}}/{path}", "-o", f"{{out}}/{name}", "-q"))
    return Case(name, tuple(words))


def case_of(path: str) -> str:
    """Return the name of the case of a path in ``{shared}``."""
    return "_".join(Path(path).parts[-2:])


def shared_tables() -> dict[str, Path]:
    """Return the tables of the second set that are there, by the names of their cases."""
    paths = {case_of(path): SHARED / path for path in SHARED_TABLES}
    return {name: path for name, path in paths.items() if path.exists()}


def shared_cases() -> list[Case]:
    """Return the second set: of third-party files beside the repository, where they are.

    Exports of angles alone hold no places.
    """
    samples = sorted((SHARED / "tracker" / "samples").glob("*"))
    paths = [f"tracker/samples/{path.name}" for path in samples if "angles" not in path.name]
    paths += [path for path in SHARED_TABLES if path.startswith("cases/")]
    cases = [_read(path) for path in paths if (SHARED / path).exists()]
    cases += [
        _run(f"cases_{name}", f"{{shared}}/cases/{name}")
        for name in SHARED_CLIPS
        if (SHARED / "cases" / name).exists()
    ]
    return cases


def all_cases(inputs: Path) -> list[Case]:
    """Return every case whose inputs are in the folder, those that others need first."""
    cases = [_run(SAMPLE, f"{{inputs}}/{SAMPLE}.mp4")]
    cases += [_run(f"clip_{name}", f"{{inputs}}/{name}.mp4") for name in CLIPS]
    cases.append(_run("pictures", "{inputs}/pictures", words=("--fps", "25", "--frames", "2:20")))
    cases.append(_run("picture", "{inputs}/pictures/0000.png"))
    for name in WRITERS:
        files = sorted((inputs / "tables" / name).glob("*"))
        written = [f"{{inputs}}/tables/{name}/{file.name}" for file in files]
        cases.append(_run(f"table_{name}", *written))
    for name, (_, options) in SHOTS.items():
        cases.append(_simulate(f"simulate_{name}", f"{{inputs}}/shots/{name}.toml", *options))
    cases.append(Case("check", (("check", f"{{inputs}}/{SAMPLE}.mp4", "-o", "{out}/check", "-q"),)))
    earlier = "{inputs}/earlier/sample"
    cases.append(_simulate("simulate_earlier", earlier, "--samples", "100"))
    cases.append(_run("earlier_tracks", f"{earlier}/tracks.csv"))
    cases += shared_cases()
    throw = ("--speed", "1.1x", "--samples", "100")
    cases.append(_simulate("simulate_sample", f"{{out}}/{SAMPLE}", *throw, needs=(SAMPLE,)))
    both = (SAMPLE, "clip_moving")
    runs = [f"{{out}}/{name}" for name in both]
    cases.append(Case("season", (("season", *runs, "-o", "{out}/season"),), needs=both))
    return cases
