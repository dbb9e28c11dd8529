"""A shot written by hand: ``SHOT.toml`` in, `Shot` out, or one line with all its mistakes."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from curlshot.data.errors import InputError
from curlshot.physics.registry import models, parameters_of
from curlshot.physics.simulator.bounds import Bounds
from curlshot.physics.simulator.simulation import FARTHEST, FASTEST, Shot, StoneStart, overlaps

RADIUS = 0.145
"""Radius of a stone where the file gives none, m: that of published simulators with `FCV1`."""

LARGEST = 1.0
"""Radius of a disc that is none, m: 14.5 is one in centimetres."""

_FAMILIES = {"model": ("impact", "frictional"), "ice": ("ice", "fcv1"), "curl": ("curl", "fcv1")}
"""Key in the file, the family of models that it chooses from, and the choice without it."""
_SHEETS: dict[str, Bounds | None] = {"none": None, "up": Bounds(1), "down": Bounds(-1)}
"""What `sheet` may be: ice without end, or a sheet with stones thrown up or down y."""
_STONE_KEYS = ("name", "x", "y", "vx", "vy", "omega", "theta", "omega_after", "mass")


@dataclass(frozen=True)
class _Table:
    """One table of the file, read key by key; what is wrong goes on the list of faults."""

    where: str
    content: Mapping[str, Any]
    faults: list[str]

    def only(self, known: Sequence[str]) -> None:
        """Note the keys that are not known, each with the nearest that is."""
        for key in self.content:
            if key not in known:
                near = get_close_matches(key, known, n=1, cutoff=0.5)
                hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}"
                self.faults.append(f"{self.where}: unknown key {key} ({hint})")

    def number(
        self,
        key: str,
        default: float | None,
        low: float = -math.inf,
        high: float = math.inf,
        *,
        above: bool = False,
    ) -> float:
        """Read a finite number in low..high (`above`: greater than low); no default: needed."""
        value = self.content.get(key, default)
        if value is None:
            self.faults.append(f"{self.where}: {key} is missing")
        elif isinstance(value, bool) or not isinstance(value, int | float):
            self.faults.append(f"{self.where}: {key} must be a number, not {value!r}")
        elif not _finite(value):
            self.faults.append(f"{self.where}: {key} = {value!s:.12} is not finite")
        elif not low <= value <= high or (above and value == low):
            allowed = f"within {low:g}..{high:g}" if math.isfinite(high) else f"at least {low:g}"
            if above:
                allowed = f"above {low:g}" + (f", {high:g} at most" if math.isfinite(high) else "")
            self.faults.append(f"{self.where}: {key} = {value:g} must be {allowed}")
        else:
            return float(value)
        # Stands in until the faults are reported.
        return 1.0

    def choice(self, key: str, default: str, known: Sequence[str]) -> str:
        """Read one of the known words."""
        value = self.content.get(key, default)
        if isinstance(value, str) and value in known:
            return value
        near = get_close_matches(str(value), known, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(known)}"
        self.faults.append(f"{self.where}: no {key} {value!r} ({hint})")
        return default


def read_shot(path: Path) -> Shot:
    """Read a shot from a ``SHOT.toml``.

    A table ``[physics]``, all optional: model (point-mass, rigid-body, frictional) with
    restitution, stone_friction and inertia (I / (m R²)); ice (constant and penner with friction,
    fcv1 and fit with a, v_c and b), curl (none, fcv1 with turn, loss and slow), radius (m): the
    models of `curlshot.physics.registry` and their parameters; sheet (none, or up or down, the way
    of play, where stones that leave it are to be taken away). One table ``[[stone]]`` a stone:
    name, x, y (m); vx, vy (m/s), omega (rad/s), theta (rad), mass (kg) and omega_after (rad/s; a
    number, or a list with one a hit) where they matter.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    InputError
        One line that lists everything that is wrong with it.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")  # editors of Windows begin it with a mark
        content = tomllib.loads(text)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        if path.suffix.lower() != ".toml":
            raise InputError(
                f"{path}: not a shot; name a SHOT.toml or the folder of a run"
            ) from None
        why = "not a text in UTF-8" if isinstance(error, UnicodeDecodeError) else _why(error, text)
        raise InputError(f"{path}: not TOML: {why}") from None
    faults: list[str] = []
    _Table("file", content, faults).only(("physics", "stone"))
    shot = _shot(content, faults)
    if faults:
        # Names and words from the file may hold line breaks.
        raise InputError(" ".join(f"{path}: {'; '.join(faults)}".split()))
    return shot


def _why(error: tomllib.TOMLDecodeError, text: str) -> str:
    """Say what is no TOML, with the line that it is in."""
    place = re.search(r"at line (\d+)", str(error))
    if place is None:
        return str(error)
    line = text.split("\n")[int(place[1]) - 1]  # as tomllib counts them
    return f"{error}: “{line.strip()[:60]}”"


def _shot(content: Mapping[str, Any], faults: list[str]) -> Shot:
    laws = content.get("physics", {})
    if not isinstance(laws, dict):
        faults.append("physics must be a table, [physics]")
        laws = {}
    tables = content.get("stone", [])
    if not (isinstance(tables, list) and all(isinstance(item, dict) for item in tables)):
        faults.append("stones must be tables, [[stone]]")
        tables = []
    elif not tables:
        faults.append("no stone: add a table [[stone]] with name, x and y")
    physics = _Table("[physics]", laws, faults)
    known = {item.name for family, _ in _FAMILIES.values() for item in _parameters(family)}
    physics.only((*_FAMILIES, *sorted(known), "radius", "sheet"))
    radius = physics.number("radius", RADIUS, 0.0, LARGEST, above=True)
    bounds = _SHEETS[physics.choice("sheet", "none", tuple(_SHEETS))]
    impact, ice, curl = [_model(physics, key) for key in _FAMILIES]
    stones = tuple(_stone(k, item, faults) for k, item in enumerate(tables, start=1))
    _check_together(stones, radius, faults)
    if bounds is not None and not faults:
        _check_way(stones, bounds, faults)
    if faults:
        return Shot(stones)
    return Shot(stones, impact(), ice(), curl(), radius, bounds)


def _parameters(family: str) -> list[Field[Any]]:
    """Return the parameters of all models of a family."""
    return [item for kind in models(family).values() for item in parameters_of(kind)]


def _model(physics: _Table, key: str) -> Callable[[], Any]:
    """Read the model that `key` names with its parameters; made once all is known to be well.

    Parameters of other models of impact may stay in the file, so that one word changes the
    model; one that the ice or the curl does not have is a mistake.
    """
    family, default = _FAMILIES[key]
    kinds = models(family)
    kind = kinds[physics.choice(key, default, tuple(kinds))]
    own = parameters_of(kind)
    if key != "model":
        for name in sorted({item.name for item in _parameters(family)} & set(physics.content)):
            if name not in _names(kind):
                has = [word for word, other in kinds.items() if name in _names(other)]
                choices = " or ".join(f'"{word}"' for word in has)
                physics.faults.append(f"[physics]: {name} is for {key} = {choices}")
    defaults: dict[str, Any] = {item.name: item.default for item in own}
    given = {
        item.name: physics.number(item.name, defaults[item.name], **item.metadata) for item in own
    }
    return lambda: kind(**given)


def _names(kind: type[Any]) -> set[str]:
    return {item.name for item in parameters_of(kind)}


def _stone(rank: int, content: Mapping[str, Any], faults: list[str]) -> StoneStart:
    name = content.get("name")
    known = isinstance(name, str) and name.strip() != ""
    table = _Table(f"stone {name}" if known else f"stone number {rank}", content, faults)
    if not known:
        faults.append(f"{table.where}: name is missing or no text")
    table.only(_STONE_KEYS)
    return StoneStart(
        name=str(name),
        x=table.number("x", None, -FARTHEST, FARTHEST),
        y=table.number("y", None, -FARTHEST, FARTHEST),
        vx=table.number("vx", 0.0, -FASTEST, FASTEST),
        vy=table.number("vy", 0.0, -FASTEST, FASTEST),
        omega=table.number("omega", 0.0, -FASTEST, FASTEST),
        theta=table.number("theta", 0.0),
        omega_after=_spins(table),
        mass=table.number("mass", StoneStart.mass, 0.0, above=True),
    )


def _spins(table: _Table) -> float | tuple[float, ...] | None:
    given = table.content.get("omega_after")
    if given is None:
        return None
    if not isinstance(given, list):
        return table.number("omega_after", None)
    if not given:
        table.faults.append(f"{table.where}: omega_after is an empty list")
    spins = [_Table(table.where, {"omega_after": item}, table.faults) for item in given]
    return tuple(spin.number("omega_after", None) for spin in spins)


def _check_together(stones: Sequence[StoneStart], radius: float, faults: list[str]) -> None:
    """Note names given twice; places too, where no stone has a fault of its own."""
    names = [stone.name for stone in stones]
    twice = sorted({name for name in names if name != "None" and names.count(name) > 1})
    faults += [f"two stones named {name}" for name in twice]
    if faults:
        return
    faults += overlaps(stones, radius)


def _check_way(stones: Sequence[StoneStart], bounds: Bounds, faults: list[str]) -> None:
    """Note a sheet on which the fastest stone goes against the way of play."""
    fastest = max(stones, key=lambda stone: math.hypot(stone.vx, stone.vy))
    if fastest.vy * bounds.play < 0:
        way, other = ("up", "down") if fastest.vy > 0 else ("down", "up")
        faults.append(
            f'sheet = "{other}" is for stones thrown {other} y, but {fastest.name} goes {way}'
        )


def _finite(value: float) -> bool:
    """Tell whether a number is finite as a float; TOML's integers know no bounds."""
    try:
        return math.isfinite(float(value))
    except OverflowError:
        return False
