from __future__ import annotations

import numpy as np

from curlshot.report import figures
from curlshot.report.style import GREEN


def test_a_glide_is_drawn_along_the_measured_speed(shot):
    figure = figures.motion_figure(shot.tracks, "C", shot.results.collisions, shot.results.glides)
    (line,) = [line for line in figure.axes[2].lines if line.get_color() == GREEN]
    track = shot.tracks[shot.tracks["stone"] == "C"]
    speed = np.interp(line.get_xdata(), track["t"], np.hypot(track["vx"], track["vy"]))
    np.testing.assert_allclose(line.get_ydata(), speed, atol=0.02)


def test_one_wide_spot_of_a_band_does_not_squeeze_the_rest(shot):
    tracks = shot.tracks.copy()
    tracks.loc[tracks["frame"].between(38, 40), ["sd_omega", "sd_vx", "sd_x"]] = 50.0
    for figure in (
        figures.spin_figure(tracks, "B", shot.results.collisions),
        figures.motion_figure(tracks, "B", shot.results.collisions),
    ):
        for ax in figure.axes:
            assert np.ptp(ax.get_ylim()) < 6
