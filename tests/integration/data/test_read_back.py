"""Tracks of an earlier run, read again: what was measured, or else smoothed places alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from curlshot.data.errors import InputError
from curlshot.data.export import write_csv, write_text
from curlshot.data.tracker import read_table
from curlshot.data.tracks import MEASURED_AS, write_tracks
from curlshot.data.trk_write import plain_view, project_xml, write_trk
from curlshot.physics.estimate import estimate
from curlshot.physics.kalman import smooth
from curlshot.physics.local_fit.hit_detection import detect_hits
from curlshot.tests.helpers.physics.watch import RADIUS, hit_motion, watch

RESTITUTION, FRICTION = 0.83, 0.0109


def measured(detections: pd.DataFrame) -> np.ndarray:
    """Restitution and friction with their errors, shape (2, 2)."""
    found = estimate(detections, detect_hits(detections, RADIUS), radius=RADIUS)
    (hit,) = found.collisions
    return np.array(
        [[hit.restitution, hit.stderr], [found.friction.value, found.friction.stderr]], float
    )


def test_errors_from_earlier_tracks_are_not_falsely_small(tmp_path: Path) -> None:
    motion = hit_motion()
    first, again = [], []
    for seed in range(4):
        detections = watch(motion, np.random.default_rng(seed), sd=0.003)
        first.append(measured(detections))
        tracks = smooth(detections, detect_hits(detections, RADIUS), radius=RADIUS)
        write_tracks(tracks, tmp_path / "tracks.csv")
        again.append(measured(read_table([tmp_path / "tracks.csv"]).detections))
    truth = np.array([RESTITUTION, FRICTION])
    values, errors = np.moveaxis(np.array(again), -1, 0)
    assert (np.abs(values - truth) < 3 * errors).all()
    # Smoothing adds nothing to what was seen.
    assert (errors > 0.8 * np.array(first)[..., 1]).all()


def with_oddities() -> pd.DataFrame:
    """Return detections with shared errors, gaps, and one that the filter refuses."""
    detections = watch(hit_motion(), np.random.default_rng(1), sd=0.003)
    detections = detections.drop(index=[3, 4]).reset_index(drop=True)
    detections.loc[20, "x"] += 0.5
    detections.loc[[7, 8], ["theta", "sd_theta"]] = np.nan
    return detections.assign(sd_place_x=0.001, sd_place_y=0.002, rise_a=0.01, rise_b=-0.02)


def test_what_was_measured_is_read_again(tmp_path: Path) -> None:
    detections = with_oddities()
    tracks = smooth(detections, detect_hits(detections, RADIUS), radius=RADIUS)
    assert (tracks["seen"] == 0).sum() > 2
    write_tracks(tracks, tmp_path / "tracks.csv", detections)
    again = read_table([tmp_path / "tracks.csv"])
    assert not again.warnings
    table = pd.read_csv(tmp_path / "tracks.csv")
    table.loc[table["stone"] == "A", "x"] = np.nan  # struck out by hand
    table.to_csv(tmp_path / "other.csv", index=False)
    assert set(read_table([tmp_path / "other.csv"]).detections["stone"]) == {"B"}
    pd.testing.assert_frame_equal(again.detections, detections, rtol=1e-8, check_dtype=False)
    np.testing.assert_allclose(measured(again.detections), measured(detections), rtol=1e-5)


def written(folder: Path) -> tuple[Path, pd.DataFrame, pd.DataFrame]:
    """Return the file of a run's tracks, its table, and the detections."""
    detections = with_oddities()
    tracks = smooth(detections, detect_hits(detections, RADIUS), radius=RADIUS)
    path = folder / "tracks.csv"
    write_tracks(tracks, path, detections)
    return path, pd.read_csv(path), detections


@pytest.mark.parametrize("change", ["turned", "shifted", "scaled", "other stone"])
def test_places_that_were_edited_count(tmp_path: Path, change: str) -> None:
    path, table, _ = written(tmp_path)
    if change == "turned":
        table[["x", "y"]] = -table[["x", "y"]]
    elif change == "shifted":
        table["x"] += 0.05
    elif change == "scaled":
        table[["x", "y"]] *= 1.05
    else:
        table.loc[table["stone"] == "A", "x"] += 1.0
    table.to_csv(path, index=False)
    found = read_table([path])
    assert any("edited" in text for text in found.warnings)
    seen = table[table["seen"] != 0]
    np.testing.assert_allclose(found.detections[["x", "y"]], seen[["x", "y"]], rtol=1e-9)


def test_places_in_another_unit_are_not_edited(tmp_path: Path) -> None:
    path, table, detections = written(tmp_path)
    table[["x", "y", "sd_x", "sd_y"]] *= 100
    table["theta"] = np.degrees(table["theta"])
    table.to_csv(path, index=False)
    found = read_table([path], length_unit="cm", angle_unit="deg")
    assert not found.warnings
    pd.testing.assert_frame_equal(found.detections, detections, rtol=1e-8, check_dtype=False)


def test_single_places_that_were_edited_or_added_count(tmp_path: Path) -> None:
    path, table, detections = written(tmp_path)
    one, other = 30, table.index[table["stone"] == "B"][10]
    table.loc[one, "x"] += 0.3
    table.loc[other, list(MEASURED_AS)] = np.nan
    table.loc[40, "y"] = np.nan  # struck out
    table.to_csv(path, index=False)
    found = read_table([path])
    assert [text for text in found.warnings if ": 1 places differ" in text and "edited" in text]
    for row in (one, other):
        mine = found.detections[
            (found.detections[["stone", "t"]] == table.loc[row, ["stone", "t"]]).all(axis=1)
        ]
        np.testing.assert_allclose(mine[["x", "y"]], table.loc[[row], ["x", "y"]].astype(float))
    assert len(found.detections) == len(detections) - 1


def test_a_stone_without_measurements_keeps_its_places(tmp_path: Path) -> None:
    """Rows of an older table beside those of this one."""
    path, table, detections = written(tmp_path)
    old = table["stone"] == "B"
    table.loc[old, list(MEASURED_AS)] = np.nan
    table.to_csv(path, index=False)
    found = read_table([path]).detections.set_index("stone")
    kept = table[old & (table["seen"] == 1)]
    np.testing.assert_allclose(found.loc["B", ["x", "sd_x"]], kept[["x", "sd_x"]])
    measured = detections.set_index("stone").loc["A", ["x", "y", "theta"]]
    np.testing.assert_allclose(found.loc["A", ["x", "y", "theta"]], measured, rtol=1e-8)


@pytest.mark.parametrize("measured", [True, False])
def test_rows_that_a_filter_carried_alone_are_refused(tmp_path: Path, measured: bool) -> None:
    path, table, _ = written(tmp_path)
    carried = table[table["meas_x"].isna()]
    assert len(carried)
    if not measured:
        carried = carried.drop(columns=list(MEASURED_AS))
    carried.to_csv(path, index=False)
    with pytest.raises(InputError, match="no row with a place"):
        read_table([path])
    table.drop(columns="seen").to_csv(path, index=False)
    assert len(read_table([path]).detections) == len(table) - len(carried)


def test_parquet_of_a_run_s_table_is_read_alike(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, table, detections = written(tmp_path)
    monkeypatch.setattr("curlshot.data.tracker.read_parquet", lambda _: table)
    found = read_table([path.with_suffix(".parquet")])
    assert not found.warnings
    pd.testing.assert_frame_equal(found.detections, detections, rtol=1e-8, check_dtype=False)


@pytest.mark.parametrize("rows", ["smoothed", "measured"])
@pytest.mark.parametrize("ending", [".txt", ".csv", ".trk"])
def test_places_keep_their_errors_in_every_form(tmp_path: Path, ending: str, rows: str) -> None:
    """Alone smoothed ones would pass for detections without noise, and e for exact."""
    detections = with_oddities()
    tracks = smooth(detections, detect_hits(detections, RADIUS), radius=RADIUS)
    write_tracks(tracks, tmp_path / "tracks.csv", detections if rows == "measured" else None)
    table = read_table([tmp_path / "tracks.csv"]).detections
    path = tmp_path / f"a{ending}"
    if ending == ".trk":
        view = plain_view(table)
        marks = view.coordinates.pixels(table["frame"], table[["x", "y"]].to_numpy())
        write_trk(project_xml(table, view, marks), path)
    else:
        (write_text if ending == ".txt" else write_csv)(table, path)
    pd.testing.assert_frame_equal(read_table([path]).detections, table)
