"""Tracks of an earlier run, read again: what was measured, or else smoothed places alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from data.export import write_csv, write_text
from data.tracker import read_table
from data.tracks import write_tracks
from data.trk_write import plain_view, project_xml, write_trk
from physics.contacts import find_contacts
from physics.estimate import estimate
from physics.kalman import smooth
from tests.physics.watch import RADIUS, hit_motion, watch

RESTITUTION, FRICTION = 0.83, 0.0109


def measured(sightings: pd.DataFrame) -> np.ndarray:
    """Restitution and friction with their errors, shape (2, 2)."""
    found = estimate(sightings, find_contacts(sightings, RADIUS), radius=RADIUS)
    (hit,) = found.collisions
    return np.array(
        [[hit.restitution, hit.stderr], [found.friction.value, found.friction.stderr]], float
    )


def test_errors_from_earlier_tracks_are_not_falsely_small(tmp_path: Path) -> None:
    motion = hit_motion()
    first, again = [], []
    for seed in range(4):
        sightings = watch(motion, np.random.default_rng(seed), sd=0.003)
        first.append(measured(sightings))
        tracks = smooth(sightings, find_contacts(sightings, RADIUS), radius=RADIUS)
        write_tracks(tracks, tmp_path / "tracks.csv")
        again.append(measured(read_table([tmp_path / "tracks.csv"]).sightings))
    truth = np.array([RESTITUTION, FRICTION])
    values, errors = np.moveaxis(np.array(again), -1, 0)
    assert (np.abs(values - truth) < 3 * errors).all()
    # Smoothing adds nothing to what was seen.
    assert (errors > 0.8 * np.array(first)[..., 1]).all()


def with_oddities() -> pd.DataFrame:
    """Return sightings with shared errors, gaps, and one that the filter refuses."""
    sightings = watch(hit_motion(), np.random.default_rng(1), sd=0.003)
    sightings = sightings.drop(index=[3, 4]).reset_index(drop=True)
    sightings.loc[20, "x"] += 0.5
    sightings.loc[[7, 8], ["theta", "sd_theta"]] = np.nan
    return sightings.assign(sd_place_x=0.001, sd_place_y=0.002)


def test_what_was_measured_is_read_again(tmp_path: Path) -> None:
    sightings = with_oddities()
    tracks = smooth(sightings, find_contacts(sightings, RADIUS), radius=RADIUS)
    assert (tracks["seen"] == 0).sum() > 2
    write_tracks(tracks, tmp_path / "tracks.csv", sightings)
    again = read_table([tmp_path / "tracks.csv"])
    assert not again.warnings
    table = pd.read_csv(tmp_path / "tracks.csv")
    table.loc[table["stone"] == "A", "x"] = np.nan  # struck out by hand
    table.to_csv(tmp_path / "other.csv", index=False)
    assert set(read_table([tmp_path / "other.csv"]).sightings["stone"]) == {"B"}
    pd.testing.assert_frame_equal(again.sightings, sightings, rtol=1e-8, check_dtype=False)
    np.testing.assert_allclose(measured(again.sightings), measured(sightings), rtol=1e-5)


@pytest.mark.parametrize("change", ["turned", "centimetres", "other stone"])
def test_places_that_were_edited_count(tmp_path: Path, change: str) -> None:
    sightings = with_oddities()
    tracks = smooth(sightings, find_contacts(sightings, RADIUS), radius=RADIUS)
    path = tmp_path / "tracks.csv"
    write_tracks(tracks, path, sightings)
    table = pd.read_csv(path)
    if change == "turned":
        table[["x", "y"]] = -table[["x", "y"]]
    elif change == "centimetres":
        table[["x", "y"]] *= 100
    else:
        table.loc[table["stone"] == "A", "x"] += 1.0
    table.to_csv(path, index=False)
    found = read_table([path], length_unit="cm" if change == "centimetres" else "m")
    assert any("edited" in text for text in found.warnings)
    seen = table[table["seen"] != 0]
    size = 0.01 if change == "centimetres" else 1.0
    np.testing.assert_allclose(
        found.sightings[["x", "y"]], size * seen[["x", "y"]].to_numpy(), rtol=1e-9
    )


@pytest.mark.parametrize("rows", ["smoothed", "measured"])
@pytest.mark.parametrize("ending", [".txt", ".csv", ".trk"])
def test_places_keep_their_errors_in_every_form(tmp_path: Path, ending: str, rows: str) -> None:
    """Alone smoothed ones would pass for sightings without noise, and e for exact."""
    sightings = with_oddities()
    tracks = smooth(sightings, find_contacts(sightings, RADIUS), radius=RADIUS)
    write_tracks(tracks, tmp_path / "tracks.csv", sightings if rows == "measured" else None)
    table = read_table([tmp_path / "tracks.csv"]).sightings
    path = tmp_path / f"a{ending}"
    if ending == ".trk":
        view = plain_view(table)
        marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
        write_trk(project_xml(table, view, marks), path)
    else:
        (write_text if ending == ".txt" else write_csv)(table, path)
    pd.testing.assert_frame_equal(read_table([path]).sightings, table)
