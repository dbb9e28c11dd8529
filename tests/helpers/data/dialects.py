"""Exports and projects as Tracker writes them, in its dialects."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

RED = "red stone"
YELLOW = "yellow"


def truth(n: int = 40, fps: float = 30.0) -> pd.DataFrame:
    """Two stones on parabolas; the second is not seen in every frame."""
    frame = np.arange(n)
    t = frame / fps
    red = pd.DataFrame(
        {
            "stone": RED,
            "frame": frame,
            "t": t,
            "x": -2.6 + 0.9 * t,
            "y": -1.16 + 1.7 * t - 0.05 * t**2,
        }
    )
    yellow = red.assign(stone=YELLOW, x=1.9 - 0.31 * t, y=0.0123 - 0.4 * t)
    return pd.concat([red, yellow[(frame > 3) & (frame % 7 != 0)]], ignore_index=True)


def java(value: float, pattern: str) -> str:
    """Print a number as Tracker does: full precision, or four significant digits."""
    if not np.isfinite(value):
        return ""
    if pattern == "full":
        mantissa, exponent = f"{value:.6E}".split("E")
        return f"{mantissa}E{int(exponent)}"
    size = abs(value)
    if 0 < size < 0.1 or size >= 1000:
        mantissa, exponent = f"{value:.3E}".split("E")
        return f"{mantissa}E{int(exponent)}"
    return f"{value:.{3 if size < 10 else 2 if size < 100 else 1}f}"


def export(
    table: pd.DataFrame,
    delimiter: str = "\t",
    pattern: str = "full",
    decimal: str = ".",
    swedish: bool = False,
    columns: Sequence[str] = ("x", "y", "vx", "frame"),
) -> str:
    """Write tracks in the layout of Tracker 6."""
    stones = list(dict.fromkeys(table["stone"]))
    lines = ["#multi:"] if len(stones) > 1 else []
    lines.append(delimiter + "".join(stone + delimiter * len(columns) for stone in stones))
    lines.append("t" + delimiter + "".join(name + delimiter for name in columns) * len(stones))

    def text(value: float, form: str) -> str:
        plain = (f"{value:.3f}" if form == "ms" else java(value, form)).replace(".", decimal)
        if swedish and plain:
            plain = plain.replace("E", "×10^").replace("-", "\N{MINUS SIGN}")
        return plain

    by_stone = {stone: rows.set_index("frame") for stone, rows in table.groupby("stone")}
    times = table.drop_duplicates("frame").set_index("frame")["t"].sort_index()
    for frame, t in times.items():
        cells = [text(t, "full" if pattern == "full" else "ms")]
        for stone in stones:
            here = by_stone[stone]
            for name in columns:
                if frame not in here.index:
                    cells.append("")
                elif name == "frame":
                    cells.append(str(frame))
                else:
                    value = here[name][frame] if name in here else 99.0
                    cells.append(text(value, pattern))
        lines.append(delimiter.join(cells))
    return "\n".join(lines) + "\n"


KEYS = {0: (160.0, 120.0, 10.0, 50.0, 50.0), 3: (170.0, 110.0, -25.0, 40.0, 42.0)}
MARKS = {"red": {n: (40.0 + 9 * n, 200.0 - 8 * n) for n in range(6)}, "blue": {2: (200.0, 50.0)}}


def numbers(**values: float) -> str:
    return "".join(f'<property name="{k}" type="double">{v}</property>' for k, v in values.items())


def sparse(name: str, entries: Mapping[int, str]) -> str:
    items = "".join(
        f'<property name="[{n}]" type="object"><object class="a.b.C$D">{body}</object></property>'
        for n, body in entries.items()
    )
    return f'<property name="{name}" type="array" class="[La.b;">{items}</property>'


def project(
    marks: Mapping[str, Mapping[int, tuple[float, float]]] = MARKS,
    keys: Mapping[int, tuple[float, ...]] = KEYS,
    clip: str = "",
    root: str = "",
    video: str = "",
    mass: Mapping[str, float] | None = None,
    duration: float = 40.0,
) -> str:
    """Write a project as Tracker does, in as few words as it reads."""
    names = ("xorigin", "yorigin", "angle", "xscale", "yscale")
    coords = {n: numbers(**dict(zip(names, row, strict=True))) for n, row in keys.items()}
    tracks = "".join(
        '<property name="item" type="object"><object class="x.tracker.PointMass">'
        + numbers(mass=(mass or {}).get(name, 1.0))
        + f'<property name="name" type="string"><![CDATA[{name}]]></property>'
        + sparse("framedata", {n: numbers(x=x, y=y) for n, (x, y) in rows.items()})
        + "</object></property>"
        for name, rows in marks.items()
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?><object class="x.tracker.TrackerPanel">'
        '<property name="videoclip" type="object"><object class="x.VideoClip">'
        f'<property name="video" type="object"><object class="x.V">{video}</object></property>'
        f'{clip}</object></property><property name="clipcontrol" type="object">'
        f'<object class="x.StepperClipControl">{numbers(delta_t=duration)}</object></property>'
        '<property name="coords" type="object"><object class="x.ImageCoordSystem">'
        f"{sparse('framedata', coords)}</object></property>{root}"
        f'<property name="tracks" type="collection" class="x">{tracks}</property></object>'
    )


def archive(entries: Mapping[str, str | bytes]) -> bytes:
    """Pack files, as a ``.trz`` does."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in entries.items():
            file.writestr(name, content)
    return buffer.getvalue()


def put(folder: Path, text: str | bytes, name: str = "shot.trk") -> Path:
    """Write a file."""
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path
