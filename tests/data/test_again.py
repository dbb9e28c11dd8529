"""Tracks of an earlier run, read again: their places are smoothed, no longer independent."""

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


@pytest.mark.parametrize("ending", [".txt", ".csv", ".trk"])
def test_smoothed_places_keep_their_errors_in_every_form(tmp_path: Path, ending: str) -> None:
    """Alone they would pass for sightings without noise, and e for exact."""
    sightings = watch(hit_motion(), np.random.default_rng(1), sd=0.003)
    tracks = smooth(sightings, find_contacts(sightings, RADIUS), radius=RADIUS)
    write_tracks(tracks, tmp_path / "tracks.csv")
    table = read_table([tmp_path / "tracks.csv"]).sightings
    path = tmp_path / f"a{ending}"
    if ending == ".trk":
        view = plain_view(table)
        marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
        write_trk(project_xml(table, view, marks), path)
    else:
        (write_text if ending == ".txt" else write_csv)(table, path)
    pd.testing.assert_frame_equal(read_table([path]).sightings, table)
