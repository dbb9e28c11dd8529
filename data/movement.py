"""Tracks as a dataset of the package movement: time, space, individuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from curlshot.data.errors import InputError, MissingPackageError
from curlshot.data.results import Input

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_VECTORS = {"position": ("x", "y", "m"), "velocity": ("vx", "vy", "m/s")}
_SCALARS = {"orientation": ("theta", "rad"), "angular_velocity": ("omega", "rad/s")}


def movement_dataset(tracks: pd.DataFrame, source: Input) -> xr.Dataset:
    """Return tracks as movement has them.

    Parameters
    ----------
    tracks : DataFrame
        With `curlshot.data.tracks.TRACK_COLUMNS`.
    source : Input
        What they were measured from.

    Returns
    -------
    Dataset
        ``position`` (m) and ``velocity`` (m/s) over time, space and individuals, ``orientation``
        (rad), ``angular_velocity`` (rad/s) and ``seen`` over time and individuals, and the
        standard deviations of all but ``seen``, named ``…_sd``. Units are in ``attrs["units"]``.
        NaN where a stone has no row.

    Raises
    ------
    MissingPackageError
        Where xarray is not installed.
    InputError
        A table without rows.
    """
    try:
        import xarray as xr
    except ImportError:
        raise MissingPackageError(
            "to_xarray needs the package xarray: pip install xarray"
        ) from None

    if tracks.empty:
        raise InputError("no tracks: there is nothing to put into a dataset")
    times, row = np.unique(tracks["t"].to_numpy(float), return_inverse=True)
    stones, rank = np.unique(tracks["stone"].to_numpy(str), return_inverse=True)

    def column(name: str) -> NDArray[np.float64]:
        out = np.full((len(times), len(stones)), np.nan)
        out[row, rank] = tracks[name].to_numpy(float)
        return out

    data: dict[str, tuple[tuple[str, ...], object, dict[str, str]]] = {}
    for sd, ending in (("", ""), ("sd_", "_sd")):
        for name, (x, y, unit) in _VECTORS.items():
            both = np.stack([column(f"{sd}{x}"), column(f"{sd}{y}")], axis=1)
            data[f"{name}{ending}"] = ("time", "space", "individuals"), both, {"units": unit}
        for name, (key, unit) in _SCALARS.items():
            data[f"{name}{ending}"] = (
                ("time", "individuals"), column(f"{sd}{key}"), {"units": unit}
            )  # fmt: skip
    data["seen"] = ("time", "individuals"), column("seen"), {"units": ""}
    attrs: dict[str, object] = {
        "source_software": "curlshot",
        "source_file": ", ".join(source.files),
        "time_unit": "seconds",
    }  # fmt: skip
    if source.fps is not None:
        attrs["fps"] = source.fps
    return xr.Dataset(
        data,
        coords={"time": times, "space": ["x", "y"], "individuals": stones},
        attrs=attrs,
    )
