"""Golden runs that are stored: what is kept of each, and how near a new run comes to it.

Numbers are compared with a physical tolerance, so that another processor or another release of a
library passes: places to 1 mm, velocities to 5 mm/s, angles to 0.02 rad, estimates to 0.2 of
their standard errors, a camera by where it maps ice points of the house, to 1 mm.
"""

from __future__ import annotations

import gzip
import json
import math
import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import curlshot
from curlshot import pipeline
from curlshot.data.results_file import write_results
from curlshot.report.summary import simulation_json
from curlshot.synthetic.camera import Lens
from curlshot.tests.golden.cases import SAMPLE, SETTINGS, SHOTS, shared_tables
from curlshot.tests.golden.clips import CLIPS
from curlshot.tests.golden.compare import IGNORED, WORDS, flat, renamed
from curlshot.tests.golden.tables import WRITERS

Floats = NDArray[np.float64]
Place = tuple[str, ...]

EXPECTED = Path(__file__).parent / "expected"
SEASON = ("table_tab_full", "table_one_hit")
CHECKED = "lines_360"
"""Cases that are combined, and the clip that is checked."""

EVERY = 5
"""Of the frames of a run one in so many is kept."""

DIGITS = 7
"""Significant digits that are kept."""

DROPPED = IGNORED | WORDS | {
    "methods", "model_selection", "joint_estimate", "residuals", "posterior", "hits",
}  # fmt: skip
"""Keys of results that are not kept: sentences, and what is not of the answer itself.

The last bits of a number decide which of two laws of almost the same weight comes first."""


@dataclass(frozen=True)
class Nearness:
    """How near runs of a case must come to each other.

    Attributes
    ----------
    errors : float
        Largest difference of a value, in its standard errors.
    of_error : float
        Largest difference of a standard error, as a share of it.
    half_turns : bool
        Whether angles of stones may differ by half a turn.
    """

    errors: float
    of_error: float
    half_turns: bool = False


EXACT_INPUT = Nearness(0.2, 0.2)
"""Of the bundled clip and of tables, which are the same files everywhere."""

RENDERED = Nearness(1.5, 0.7, half_turns=True)
"""Of rendered clips. Renderer and encoder round otherwise on a processor without AVX2, and that is
other noise in every frame. Estimates from 2.4 s of such a clip differ by about their standard
errors then, as between two takes of one shot. Where a handle hardly shows its free end, angles may
differ by half a turn."""

MILLIMETRE = 1e-3
LIMITS: Mapping[str, float] = {
    **dict.fromkeys(("x", "y", "rmse", "rest_error", "rest_sd"), MILLIMETRE),
    **dict.fromkeys(("error_at_comparison", "sd_at_comparison"), MILLIMETRE),
    **dict.fromkeys(("vx", "vy", "speed"), 5e-3),
    **dict.fromkeys(("theta", "omega", "normal"), 0.02),
    **dict.fromkeys(("t", "duration"), 1e-3),
    # A stone comes to rest slowly: the moment is known less well.
    **dict.fromkeys(("t0", "t1"), 0.05),
    "energy_lost": 0.01,
    "turn_rate": 1e-3,
}
"""Tolerance by key or column: m, m/s, rad, s."""

SHARES: Mapping[str, float] = {
    # Constants of a law that the shot hardly tells apart, and a mean over all that was predicted.
    **dict.fromkeys(("rmse", "a", "v_c", "b"), 0.3),
}
"""Tolerance by key as a share of the value."""

ERRORS: Mapping[str, str] = {
    **dict.fromkeys(("value", "restitution", "friction"), "stderr"),
    "momentum_residual": "stderr_momentum",
    "rest_error": "rest_sd",
    "error_at_comparison": "sd_at_comparison",
    **{name: f"sd_{name}" for name in ("x", "y", "vx", "vy", "omega")},
}
"""Key of the standard error of a value, where it is neither stderr_KEY nor sd_KEY."""

PLACES = ("x", "y", "vx", "vy", "theta", "omega")
UNSURE = 0.02
"""Share of the rows in which a stone may be seen in one run and not in the other."""

_GRID = np.linspace(-1.8, 1.8, 13)
HOUSE_POINTS = np.array([(x, y) for x in _GRID for y in _GRID if np.hypot(x, y) <= 1.83])
"""Points of the ice within the house, m."""

COLOUR = 8
"""Largest difference of a channel of the colour of a team's caps."""


def names() -> list[str]:
    """Return the names of all stored cases of the first set."""
    return [
        SAMPLE, *(f"clip_{name}" for name in CLIPS), *(f"table_{name}" for name in WRITERS),
        *(f"simulate_{name}" for name in SHOTS), "season", "check",
    ]  # fmt: skip


def inputs(name: str, folder: Path) -> list[Path]:
    """Return the files of a case; those of a table are written into the folder."""
    kind, _, rest = name.partition("_")
    if name == SAMPLE:
        return [pipeline.sample_clip()]
    if kind == "clip":
        return [CLIPS[rest]().render()]
    if kind == "table":
        return WRITERS[rest](folder)
    return [shared_tables()[name]]


def measured(name: str, folder: Path) -> dict[str, Any]:
    """Run a case in this process and return what is kept of it."""
    kind, _, rest = name.partition("_")
    if kind == "simulate":
        return {"results": _kept(_simulated(rest, folder))}
    if kind in ("season", "check"):
        return {"results": _kept(_combined(folder) if kind == "season" else _checked())}
    done = pipeline.run(inputs(name, folder), overlay=False, **SETTINGS.get(name, {}))
    write_results(done.results, folder / "results.json")
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    kept: dict[str, Any] = {"results": _kept(results)}
    if name not in names():  # tracks of others are not kept
        return kept
    kept["tracks"] = _thinned(done.tracks)
    if done.cameras is not None:
        kept["camera"] = _thinned(pd.DataFrame(done.cameras))
        kept["size"] = (1280, 720) if name == SAMPLE else CLIPS[name[5:]]().camera.size
    return kept


def _simulated(name: str, folder: Path) -> dict[str, Any]:
    """Return where the stones of a written shot end, and its hits."""
    path = folder / "SHOT.toml"
    path.write_text(SHOTS[name][0], encoding="utf-8")
    found = simulation_json(curlshot.simulate(path).simulation)
    return {"rest": found["stones"], "events": found["hits"]}


def _combined(folder: Path) -> dict[str, Any]:
    """Return e and μ of two shots together."""
    runs = {}
    for name in SEASON:
        (folder / name).mkdir()
        runs[name] = pipeline.run(inputs(name, folder / name), overlay=False)
    return {name: asdict(mean) for name, mean in curlshot.combine(runs).means.items()}


def _checked() -> dict[str, Any]:
    """Return how many frames and stones a check of a clip found."""
    _, lines = curlshot.check(CLIPS[CHECKED]().render())
    return {"frames": sum("frame" in line for line in lines), "counts": _numbers(lines[1])}


def _numbers(line: str) -> list[int]:
    return [int(text) for text in re.findall(r"(?<![\d.])\d+(?![\d.])", line)]


def _kept(value: Any) -> Any:
    """Return results under their new keys, without what `DROPPED` names."""
    if isinstance(value, dict):
        return {
            renamed("results.json", key): _kept(item)
            for key, item in value.items()
            if key not in DROPPED
        }
    if isinstance(value, list):
        return [_kept(item) for item in value]
    return _rounded(value) if isinstance(value, float) else value


def _rounded(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None


def _thinned(table: pd.DataFrame) -> dict[str, list[Any]]:
    rows = table[table["frame"] % EVERY == 0]
    return {
        renamed("tracks.csv", str(column)): [
            _rounded(value) if isinstance(value, float) else value
            for value in rows[column].tolist()
        ]
        for column in rows
    }


def read(name: str) -> dict[str, Any]:
    """Return what is stored of a case."""
    text = gzip.decompress(path_of(name).read_bytes()).decode()
    stored: dict[str, Any] = json.loads(text)
    return stored


def renew(name: str) -> int:
    """Run a case, store it and return the size of its file, bytes."""
    with tempfile.TemporaryDirectory() as folder:
        kept = measured(name, Path(folder))
    text = json.dumps(kept, separators=(",", ":"), ensure_ascii=False)
    EXPECTED.mkdir(exist_ok=True)
    return path_of(name).write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def path_of(name: str) -> Path:
    """Return the file in which a case is stored."""
    return EXPECTED / f"{name}.json.gz"


def differences(name: str, old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return where a new run of a case is not near enough to the stored one, a line for each."""
    near = RENDERED if name.startswith("clip_") else EXACT_INPUT
    lines = [*_unlike(old["results"], new["results"], near)]
    if "tracks" in old:
        lines += _tracks_unlike(pd.DataFrame(old["tracks"]), pd.DataFrame(new["tracks"]), near)
    if ("camera" in old) != ("camera" in new):
        lines.append("camera: only in one of both")
    elif "camera" in old:
        before, after = pd.DataFrame(old["camera"]), pd.DataFrame(new["camera"])
        lines += _cameras_unlike(before, after, old["size"])
    return lines


def _unlike(old: Any, new: Any, near: Nearness) -> Iterator[str]:
    """Yield the leaves of results that differ by more than their tolerance."""
    before, after = (dict(flat(value, "results.json")) for value in (old, new))
    for place in dict.fromkeys([*before, *after]):
        where = ".".join(place)
        if place not in before or place not in after:
            yield f"{where}: only in the {'stored' if place in before else 'new'} run"
            continue
        left, right = before[place], after[place]
        if _number(left) and _number(right):
            tolerance = max(_tolerance(place, run, near) for run in (before, after))
            if not abs(left - right) <= tolerance:
                yield f"{where}: {left:.9g}, off by {right - left:.3g}, more than {tolerance:.3g}"
        elif not (left == right or _same_colour(left, right)):
            yield f"{where}: {left!r} -> {right!r}"


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _tolerance(place: Place, leaves: Mapping[Place, Any], near: Nearness) -> float:
    """Return by how much the number at a place of the results may differ."""
    value = abs(float(leaves[place]))
    names = [key.removeprefix("sd_").removeprefix("stderr_") for key in place]
    limit = max(LIMITS.get(key, 0.0) for key in (*names, *place))
    for at in reversed(range(len(place))):
        key, rest = place[at], place[at + 1 :]
        if key.startswith(("stderr", "sd_")) or key == "rest_sd":
            return near.of_error * (value + limit)
        found = leaves.get((*place[:at], ERRORS.get(key, f"stderr_{key}"), *rest))
        if found is not None or key in LIMITS or key in SHARES:
            return max(limit, SHARES.get(key, 0.0) * value, near.errors * float(found or 0.0))
    return 1e-6 * value


def _same_colour(old: object, new: object) -> bool:
    texts = [text for text in (old, new) if isinstance(text, str) and len(text) == 7]
    if len(texts) < 2 or not all(text.startswith("#") for text in texts):
        return False
    try:
        first, second = (np.frombuffer(bytes.fromhex(text[1:]), np.uint8) for text in texts)
    except ValueError:
        return False
    return bool((np.abs(first.astype(int) - second) <= COLOUR).all())


def _tracks_unlike(old: pd.DataFrame, new: pd.DataFrame, near: Nearness) -> Iterator[str]:
    """Yield the columns of tracks that differ by more than their tolerance."""
    rows = ["stone", "frame"]
    both = old.merge(new, on=rows, how="outer", suffixes=("", "_new"), indicator=True)
    alone = both[both["_merge"] != "both"]
    if len(alone):
        stone, frame = alone.iloc[0][rows]
        yield f"tracks: {len(alone)} rows are in one run alone, first {stone} in frame {frame}"
    both = both[both["_merge"] == "both"]
    for column in ("t", *PLACES, *(f"sd_{name}" for name in PLACES)):
        left, right = (
            pd.to_numeric(both[name]).to_numpy(float) for name in (column, f"{column}_new")
        )
        off = np.abs(right - left)
        if column == "theta":
            turn = math.pi if near.half_turns else 2 * math.pi
            off = np.abs((off + turn / 2) % turn - turn / 2)
        limit = LIMITS[column.removeprefix("sd_")]
        if column.startswith("sd_"):
            tolerance = near.of_error * (np.fmax(left, right) + limit)
        else:
            tolerance = np.full(len(both), limit)
            if f"sd_{column}" in both:
                error = pd.to_numeric(both[f"sd_{column}"]).to_numpy(float)
                tolerance = np.fmax(tolerance, near.errors * error)
        known = np.isfinite(left) & np.isfinite(right)
        wrong = (known & ~(off <= tolerance)) | (np.isfinite(left) != np.isfinite(right))
        if wrong.any():
            worst = np.flatnonzero(wrong)[np.nan_to_num(off[wrong], nan=np.inf).argmax()]
            stone, frame = both.iloc[worst][rows]
            yield (
                f"tracks: {column} in {wrong.sum()} of {len(both)} rows, worst {stone} in frame"
                f" {frame}: {left[worst]:.7g} -> {right[worst]:.7g}"
            )
    seen = (both["seen"] != both["seen_new"]).mean()
    if seen > UNSURE:
        yield f"tracks: seen differs in {100 * seen:.1f} % of the rows"
    teams = [
        pair
        for pair in zip(both["team"], both["team_new"], strict=True)
        if not (pair[0] == pair[1] or _same_colour(*pair))
    ]
    if teams:
        yield f"tracks: team {teams[0][0]!r} -> {teams[0][1]!r}"


def _cameras_unlike(old: pd.DataFrame, new: pd.DataFrame, size: tuple[int, int]) -> Iterator[str]:
    """Yield where two cameras map the house differently, in the frames that both have."""
    if old["frame"].tolist() != new["frame"].tolist():
        yield "camera: of other frames"
        return
    worst, frame, compared = 0.0, 0, 0
    for (_, before), (_, after) in zip(old.iterrows(), new.iterrows(), strict=True):
        if pd.isna(before["h11"]) or pd.isna(after["h11"]):
            if pd.isna(before["h11"]) != pd.isna(after["h11"]):
                yield f"camera: found in frame {before['frame']:.0f} of one run alone"
            continue
        pixels = _lens(before, size).distort(_mapped(_matrix(before), HOUSE_POINTS))
        shown = ((pixels >= 0) & (pixels <= np.array(size) - 1)).all(-1)
        inverse = np.asarray(np.linalg.inv(_matrix(after)), np.float64)
        back = _mapped(inverse, _lens(after, size).undistort(pixels))
        off = np.hypot(*(back - HOUSE_POINTS)[shown].T)
        compared += len(off)
        if len(off) and off.max() > worst:
            worst, frame = float(off.max()), int(before["frame"])
    if worst > MILLIMETRE:
        yield f"camera: ice points up to {1000 * worst:.2f} mm off, in frame {frame}"
    if not compared:
        yield "camera: no frame to compare"


def _lens(camera: pd.Series[Any], size: tuple[int, int]) -> Lens:
    return Lens((size[0], size[1]), float(camera["k1"]), float(camera["k2"]))


def _matrix(camera: pd.Series[Any]) -> Floats:
    """Return the homography from ice metres to undistorted pixels."""
    names = [f"h{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)]
    return np.array(camera[names].tolist(), np.float64).reshape(3, 3)


def _mapped(matrix: Floats, points: Floats) -> Floats:
    """Return points, shape (n, 2), mapped by a homography."""
    mapped = np.column_stack([points, np.ones(len(points))]) @ matrix.T
    return np.asarray(mapped[:, :2] / mapped[:, 2:])
