from __future__ import annotations

from pathlib import Path

import pytest

from curlshot.data.headers import plain_name, with_units
from curlshot.data.layouts import read_layout


@pytest.mark.parametrize(
    ("written", "plain"),
    [("v_{x} (m/s)", "vx"), (' "X" [cm]', "x"), ("θ_{r} (°)", "θr"), ("Time", "time")],
)
def test_names_lose_units_and_dress(written: str, plain: str) -> None:
    assert plain_name(written) == plain


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("t_s,x_cm,y_cm", "t (s),x (cm),y (cm)"),
        ("time_ms,Red_X_m,Red_Y_m,Red_Angle_deg", "time (ms),Red_X (m),Red_Y (m),Red_Angle (deg)"),
        ("t,x1_mm,y1_mm,x2_mm,y2_mm", "t,x1 (mm),y1 (mm),x2 (mm),y2 (mm)"),
        ("t,x_metres,y_metres", "t,x (metres),y (metres)"),
        ("t,red_x_m,red_y_m,red_velocity_x,vx", "t,red_x (m),red_y (m),red_velocity_x,vx"),
        ("t / s,x in cm,y in cm", "t (s),x (cm),y (cm)"),
        ("t,x_m,y_m,x_a,y_a", "t,x_m,y_m,x_a,y_a"),  # stones m and a
        ("t,x (m),y (m),x_s,y_s", "t,x (m),y (m),x_s,y_s"),
        ("t,xA_cm,yA_cm,xB_cm,yB_cm", "t,xA (cm),yA (cm),xB (cm),yB (cm)"),
        ("t,xpos_cm,ypos_cm", "t,xpos (cm),ypos (cm)"),
        ("t,x_cm,y_cm,v_x,v_y,a_x,a_y", "t,x (cm),y (cm),v_x,v_y,a_x,a_y"),
        ("t,x_cm,y_cm,x_px,y_px,sd_x,sd_y", "t,x (cm),y (cm),x_px,y_px,sd_x,sd_y"),
        ("t,x_m,y_m,theta_m", "t,x_m,y_m,theta_m"),  # no angle is in metres: of a stone m
        ("t,x_rad,y_rad,theta_rad", "t,x_rad,y_rad,theta_rad"),
        ("t,t_ms,x,y", "t,t_ms,x,y"),  # one column of times is enough
        ("t_s,t_ms,x_cm,y_cm", "t (s),t_ms,x (cm),y (cm)"),
        ("t_s,xA,yA,t_s,xB,yB", "t (s),xA,yA,t (s),xB,yB"),
        ("t_min,x,y,mass_m", "t_min,x,y,mass_m"),
    ],
)
def test_units_at_the_end_of_names_are_told_from_names(written: str, told: str) -> None:
    assert with_units(written.split(",")) == told.split(",")


def test_such_units_count(tmp_path: Path) -> None:
    path = tmp_path / "shot.csv"
    path.write_text("t_ms,red_x_cm,red_y_cm\n0,100,200\n40,101,202\n80,102,204\n")
    file = read_layout(path, None)
    assert file.length_unit == "cm"
    assert file.tracks["stone"].unique().tolist() == ["red"]
    assert file.tracks["t"].tolist() == pytest.approx([0, 0.04, 0.08])
