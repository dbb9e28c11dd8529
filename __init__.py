"""From a clip of a curling shot to its physics: tracks, restitution, friction, simulation.

>>> import curlshot
>>> run = curlshot.run("shot.mp4", out="shot")        # doctest: +SKIP
>>> run.restitution, run.friction                     # doctest: +SKIP
>>> run.plot()                                        # doctest: +SKIP
>>> curlshot.simulate(run, aim_offset=0.1).plot()     # doctest: +SKIP

What ``dir(curlshot)`` lists is public; everything else may change.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from curlshot.data.version import VERSION as __version__

if TYPE_CHECKING:
    from curlshot.config import (
        CameraConfig,
        Config,
        PhysicsConfig,
        ReportConfig,
        SearchConfig,
        StonesConfig,
        TablesConfig,
        VideoConfig,
    )
    from curlshot.data.errors import CurlshotError, InputError, SceneError
    from curlshot.data.estimates import Estimate
    from curlshot.data.inputs import sample_clip
    from curlshot.data.results import Hit
    from curlshot.outcome import Run, load
    from curlshot.physics.curl import FCV1Curl, NoCurl
    from curlshot.physics.ice import FCV1, Constant, Penner
    from curlshot.physics.impact import Frictional, PointMass, RigidBody
    from curlshot.physics.simulator.bounds import Bounds
    from curlshot.physics.simulator.simulation import HitEvent, Shot, StoneStart
    from curlshot.pipeline import convert, run
    from curlshot.report.check_clip import check
    from curlshot.season.batch import run_each
    from curlshot.season.together import Season, combine
    from curlshot.simulated import SimulatedShot, simulate

_MODULES = {
    "config": (
        "CameraConfig", "Config", "PhysicsConfig", "ReportConfig", "SearchConfig", "StonesConfig",
        "TablesConfig", "VideoConfig",
    ),
    "data.errors": ("CurlshotError", "InputError", "SceneError"),
    "data.estimates": ("Estimate",),
    "data.inputs": ("sample_clip",),
    "data.results": ("Hit",),
    "outcome": ("Run", "load"),
    "physics.curl": ("FCV1Curl", "NoCurl"),
    "physics.ice": ("FCV1", "Constant", "Penner"),
    "physics.impact": ("Frictional", "PointMass", "RigidBody"),
    "physics.simulator.bounds": ("Bounds",),
    "physics.simulator.simulation": ("HitEvent", "Shot", "StoneStart"),
    "pipeline": ("convert", "run"),
    "report.check_clip": ("check",),
    "season.batch": ("run_each",),
    "season.together": ("Season", "combine"),
    "simulated": ("SimulatedShot", "simulate"),
}  # fmt: skip
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "FCV1",
    "Bounds",
    "CameraConfig",
    "Config",
    "Constant",
    "CurlshotError",
    "Estimate",
    "FCV1Curl",
    "Frictional",
    "Hit",
    "HitEvent",
    "InputError",
    "NoCurl",
    "Penner",
    "PhysicsConfig",
    "PointMass",
    "ReportConfig",
    "RigidBody",
    "Run",
    "SceneError",
    "SearchConfig",
    "Season",
    "Shot",
    "SimulatedShot",
    "StoneStart",
    "StonesConfig",
    "TablesConfig",
    "VideoConfig",
    "__version__",
    "check",
    "combine",
    "convert",
    "load",
    "run",
    "run_each",
    "sample_clip",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for, so that ``import curlshot`` is quick."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names; rooms that were imported are not among them."""
    return sorted(__all__)
