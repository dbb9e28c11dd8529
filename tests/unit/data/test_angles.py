from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from curlshot.data.angles import read_angles
from curlshot.data.errors import InputError
from curlshot.data.tracker import read_table

T = np.arange(30) / 25
THETA = 2.6 + 1.4 * T - 0.1 * T**2


def put(folder: Path, text: str, name: str = "a_angle.txt") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def table(*columns: np.ndarray, digits: int = 9) -> str:
    return "".join(
        "\t".join("" if np.isnan(v) else f"{v:.{digits}f}" for v in row) + "\n"
        for row in np.column_stack(columns)
    )


@pytest.mark.parametrize("unit", ["rad", "deg"])
@pytest.mark.parametrize("start", [0.0, 0.02, 2.6, -3.1])
def test_the_point_tells_the_unit_of_its_angle(tmp_path: Path, start: float, unit: str) -> None:
    theta = THETA - THETA[0] + start
    shown = np.degrees(theta) if unit == "deg" else theta
    body = table(T, 0.14 * np.cos(theta), 0.14 * np.sin(theta), shown)
    path = put(tmp_path, "\tedge\t\t\t\nt\tx\ty\tθ\t\n" + body)
    found = read_angles(path)
    np.testing.assert_allclose(found.theta, theta, atol=1e-8)
    assert found.warnings == ()
    other = "rad" if unit == "deg" else "deg"
    assert f"the file gives angles in {unit}" in read_angles(path, other).warnings[0]


def test_a_start_beyond_half_a_turn_means_degrees(tmp_path: Path) -> None:
    path = put(tmp_path, "edge\nt\tθ\n" + table(T, np.degrees(THETA)))
    for unit in (None, "rad", "deg"):
        np.testing.assert_allclose(read_angles(path, unit).theta, THETA, atol=1e-8)


def test_without_evidence_the_unit_is_what_the_user_says(tmp_path: Path) -> None:
    path = put(tmp_path, "edge\nt\tθ\n" + table(T, THETA))
    np.testing.assert_allclose(read_angles(path, "deg").theta, np.radians(THETA), atol=1e-8)
    assert "read in radians" in read_angles(path).warnings[0]
    slow = put(tmp_path, "edge\nt\tθ\n" + table(T, 1.0 + 8 * T))
    with pytest.raises(InputError, match="degrees or in radians"):
        read_angles(slow)
    fast = put(tmp_path, "edge\nt\tθ\n" + table(T, 1.0 + 80 * T))
    assert "too fast for radians" in read_angles(fast).warnings[0]


def test_wrapped_angles_and_points_alone_run_on(tmp_path: Path) -> None:
    theta = 3.0 + 5 * T
    wrapped = np.degrees(np.angle(np.exp(1j * theta)))
    for header, columns in [
        ("t\tθr", (wrapped,)),
        ("t\tx\ty", (0.1 * np.cos(theta), 0.1 * np.sin(theta))),
        ("", (wrapped,)),
    ]:
        found = read_angles(put(tmp_path, f"{header}\n" + table(T, *columns)))
        np.testing.assert_allclose(np.diff(found.theta), np.diff(theta), atol=1e-6)


def test_missing_angles_stay_missing(tmp_path: Path) -> None:
    theta = np.where((T > 0.3) & (T < 0.6), np.nan, THETA)
    angle = put(tmp_path, "edge\nt\tθ\n" + table(T, np.degrees(theta)))
    place = put(tmp_path, "mass A\nt\tx\ty\n" + table(T, T, 2 * T, digits=3), "a.txt")
    found = read_table([place], names={"A": "mass A"}, angles={"A": angle}).detections
    np.testing.assert_allclose(found["theta"], theta, atol=1e-8)


def test_angles_meet_places_of_the_same_moment_only(tmp_path: Path) -> None:
    place = put(tmp_path, "A\nt\tx\ty\n" + table(T[::2], T[::2], T[::2], digits=3), "a.txt")
    angle = put(tmp_path, "edge\nt\tθ\n" + table(np.round(T, 3), np.degrees(THETA)))
    found = read_table([place], angles={"A": angle})
    np.testing.assert_allclose(found.detections["theta"], THETA[::2], atol=1e-8)
    assert any("15 of 30 angles have no place of A" in text for text in found.warnings)
    late = put(tmp_path, "edge\nt\tθ\n" + table(T + 9.01, THETA))
    with pytest.raises(InputError, match="none of its times"):
        read_table([place], angles={"A": late})
    with pytest.raises(InputError, match="no such stone; there are A"):
        read_table([place], angles={"B": angle})


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("t\tω\n0\t1\n1\t2\n", "no angle"),
        ("#multi:\n\ta\t\tb\t\nt\tθ\tθ\t\n0\t1\t2\n1\t1\t2\n", "several tracks"),
        ("t\tθ\n0\t\n1\t\n", "no row with an angle"),
        ("t\tθ\n", "without rows"),
        ("1\t2\t3\t4\n2\t3\t4\t5\n", "4 columns without a header"),
        ("stone,t,x,y\nA,0,1,2\nB,0,3,4\n", "several tracks; an angle needs one export per stone"),
        ("stone,t,θ\nA,0,1\nA,1,2\n", "several tracks"),
        ("hello there\n", "not a table of angles: no header with t and θ, and no rows of numbers"),
    ],
)
def test_what_is_no_angle_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        read_angles(put(tmp_path, text))


def test_names_choose_and_rename_tracks(tmp_path: Path) -> None:
    places = put(
        tmp_path, "#multi:\n\tmass A\t\tdust\t\nt\tx\ty\tx\ty\t\n0\t1\t2\t3\t4\n0.1\t1.1\t2\t3\t4\n"
    )
    assert set(read_table([places]).detections["stone"]) == {"mass A", "dust"}
    assert set(read_table([places], names={"A": "mass A"}).detections["stone"]) == {"A"}
    with pytest.raises(InputError, match="no track named mass B; there are mass A, dust"):
        read_table([places], names={"B": "mass B"})
    with pytest.raises(InputError, match="one track cannot be two stones"):
        read_table([places], names={"A": "dust", "B": "dust"})


def test_a_track_named_stone_is_no_column_of_stones(tmp_path: Path) -> None:
    track = read_angles(put(tmp_path, "#multi:\n\tstone\t\nt\tθ\t\n0\t1\n0.1\t1.2\n"))
    assert track.theta == pytest.approx([1.0, 1.2])


def test_a_point_that_is_none_of_the_edge_is_refused(tmp_path: Path) -> None:
    across = table(T, 0.3 + 0 * T, 2.5 - 2 * T)  # a stone about the tee
    with pytest.raises(InputError, match=r"the point is 0.\d+ to 2.\d+ from the origin.* Frame"):
        read_angles(put(tmp_path, "edge\nt\tx\ty\n" + across))
    badly = 0.14 * (1 + 0.3 * np.sin(9 * T))  # marks off by a third, one of them slipped
    badly[7] = 3.0
    path = put(tmp_path, "edge\nt\tx\ty\n" + table(T, badly * np.cos(THETA), badly * np.sin(THETA)))
    np.testing.assert_allclose(np.diff(read_angles(path).theta), np.diff(THETA), atol=1e-6)
