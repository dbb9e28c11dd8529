from __future__ import annotations

import dataclasses
from io import BytesIO
from itertools import combinations

import matplotlib
import numpy as np
import pandas as pd
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse
from matplotlib.text import Text
from PIL import Image

from data.results import Friction, Glide, Joint, MeasuredState
from data.sheet import HOUSE
from report import figures
from report.numbers import plus_minus
from report.style import BLACK, GREEN, PNG_DPI, render, styled
from report.tables import residual_table


def texts(figure: Figure) -> list[Text]:
    """All texts that are drawn; ticks outside of their axis are not."""
    found = [*figure.texts]
    if figure.get_suptitle():
        found.append(figure._suptitle)
    for legend in figure.legends:
        found += legend.get_texts()
    for ax in figure.axes:
        found += [ax.title, ax.xaxis.label, ax.yaxis.label, *ax.texts]
        legend = ax.get_legend()
        if legend is not None:
            found += [*legend.get_texts(), legend.get_title()]
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            found += [
                tick.label1
                for tick in axis.get_major_ticks()
                if low - 1e-9 <= tick.get_loc() <= high + 1e-9 and tick.label1.get_visible()
            ]
    return [t for t in dict.fromkeys(found) if t.get_visible() and t.get_text().strip()]


def check_layout(figure: Figure) -> None:
    """Every text within the figure, no text on another."""
    assert isinstance(figure, Figure)
    with styled():
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        width, height = canvas.get_width_height()
        boxes = []
        for text in texts(figure):
            if not text.axes or text.axes.axison or text in text.axes.texts:
                box = text.get_window_extent(canvas.get_renderer())
                boxes.append((text.get_text(), box))
                assert box.x0 >= -0.5 and box.y0 >= -0.5, text
                assert box.x1 <= width + 0.5 and box.y1 <= height + 0.5, text
    for (one, a), (two, b) in combinations(boxes, 2):
        wide = min(a.x1, b.x1) - max(a.x0, b.x0)
        high = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert wide < 1 or high < 1, f"{one!r} on {two!r}"


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_motion_says_the_fitted_velocities_with_their_errors(shot, stone):
    collisions, glides = shot.results.collisions, shot.results.glides
    figure = figures.motion_figure(shot.tracks, stone, collisions, glides)
    check_layout(figure)
    assert len(figure.axes) == 3
    said = " ".join(t.get_text() for t in texts(figure))
    for hit in collisions:
        if stone in hit.stones:
            after = hit.after[stone]
            assert f"{abs(after.vx):.3f} ± 0.012" in said
            assert f"{abs(after.vy):.3f} ± 0.015" in said
    for glide in glides:
        if glide.friction is not None:
            assert (f"± {glide.stderr}" in said) == (glide.stone == stone)


def test_a_glide_is_drawn_along_the_measured_speed(shot):
    figure = figures.motion_figure(shot.tracks, "C", shot.results.collisions, shot.results.glides)
    (line,) = [line for line in figure.axes[2].lines if line.get_color() == GREEN]
    track = shot.tracks[shot.tracks["stone"] == "C"]
    speed = np.interp(line.get_xdata(), track["t"], np.hypot(track["vx"], track["vy"]))
    np.testing.assert_allclose(line.get_ydata(), speed, atol=0.02)


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_spin_says_the_fitted_spins_with_their_errors(shot, stone):
    figure = figures.spin_figure(shot.tracks, stone, shot.results.collisions)
    check_layout(figure)
    assert [ax.get_ylabel() for ax in figure.axes] == ["angle (rad)", "spin (rad/s)"]
    said = " ".join(t.get_text() for t in texts(figure))
    for hit in shot.results.collisions:
        if stone in hit.stones:
            assert f"{hit.after[stone].omega:.3f} ± 0.021" in said


@pytest.mark.parametrize("stone", ["A", "B", "C"])
def test_comparison_has_a_line_per_model(shot, stone):
    figure = figures.comparison_figure(
        shot.tracks, shot.simulations, stone, shot.results.collisions
    )
    check_layout(figure)
    (legend,) = figure.legends
    names = [t.get_text() for t in legend.get_texts()]
    assert names[1:] == ["point-mass", "rigid-body", "frictional"]


def test_speed_is_cut_at_hits(shot):
    figure = figures.speed_figure(shot.tracks, shot.results.collisions)
    check_layout(figure)
    line = figure.axes[0].lines[0]
    t, speed = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert np.isnan(speed).sum() == 1
    assert np.nanmax(np.abs(np.diff(speed))) < 0.05
    assert t[0] == 0


@pytest.mark.parametrize("house", [HOUSE, None])
def test_plan_shows_every_stone_to_scale(shot, house):
    figure = figures.plan_figure(
        shot.tracks, shot.simulations, shot.results.collisions, house=house
    )
    check_layout(figure)
    (ax,) = figure.axes
    assert {"A", "B", "C", "D"} <= {t.get_text() for t in ax.texts}
    radii = [round(p.get_radius(), 4) for p in ax.patches if isinstance(p, Circle)]
    assert radii.count(0.1455) == 4 + 9
    assert radii.count(1.829) == (house is not None)
    assert ax.get_aspect() == 1


def test_ellipses_are_enlarged_as_the_legend_says(shot):
    figure = figures.plan_figure(shot.tracks, house=HOUSE)
    (ax,), (legend,) = figure.axes, figure.legends
    (said,) = [t.get_text() for t in legend.get_texts() if "sd" in t.get_text()]
    factor = int(said.split(",")[1].split()[0])
    sizes = [p.get_width() for p in ax.patches if type(p) is Ellipse]
    assert len(sizes) == 4
    assert sizes == pytest.approx([2 * 2 * 0.004 * factor] * 4)


def residuals(shot, sd=0.003):
    rng = np.random.default_rng(3)
    sighted = shot.tracks.assign(sd_x=sd, sd_y=sd)
    for axis in "xy":
        sighted[axis] += sd * rng.standard_normal(len(sighted))
    return residual_table(sighted, shot.tracks)


def test_residuals_that_are_normal_look_so(shot):
    table = residuals(shot)
    assert table["dx"].std() == pytest.approx(0.003, rel=0.1)
    figure = figures.residuals_figure(table, shot.results.collisions)
    check_layout(figure)
    said = [ax.get_title() for ax in figure.axes if ax.get_title()]
    assert said[0].split()[0] in ("94", "95", "96")


@pytest.mark.parametrize("curling", [True, False])
@pytest.mark.parametrize(
    "law", [Friction(0.0109, 4e-4), Friction(0.0109, 4e-4, "fit", 2e-3, 0.06, 0.009), Friction()]
)
def test_friction_shows_law_and_glides(shot, law, curling):
    figure = figures.friction_figure(shot.results.glides, law, shot.tracks, curling=curling)
    check_layout(figure)
    (ax,) = figure.axes
    low, high = ax.get_ylim()
    assert low < 0.0109 < high
    said = [t.get_text() for t in figure.legends[0].get_texts()]
    assert any("Penner" in text for text in said) == curling
    assert {"stone A", "stone C"} <= set(said)
    if law.value is not None:
        black = next(line for line in ax.lines if line.get_color() == BLACK)
        assert np.interp(1.0, *black.get_data()) == pytest.approx(
            0.0109 if law.law == "constant" else 2e-3 / 1.06 + 0.009, rel=1e-4
        )


def test_posterior_from_covariance_and_from_samples(shot):
    laws = shot.results.laws
    rng = np.random.default_rng(4)
    samples = pd.DataFrame(
        rng.multivariate_normal(laws.values, laws.cov, 3000), columns=list(laws.names)
    )
    for given in ((laws, None), (laws, samples), (None, samples)):
        figure = figures.posterior_figure(*given)
        check_layout(figure)
        assert len(figure.axes) == 9
        assert figure.axes[0].get_title().startswith("0.831 ± 0.012")
    one = Joint(("friction",), (0.0109,), ((1e-8,),))
    check_layout(figures.posterior_figure(one))
    with pytest.raises(ValueError, match="nothing to draw"):
        figures.posterior_figure(None, pd.DataFrame({"other": [1.0]}))


def test_an_ellipse_lies_as_the_covariance_says():
    laws = Joint(("restitution", "friction"), (0.8, 0.01), ((4e-4, 8e-7), (8e-7, 1e-8)))
    figure = figures.posterior_figure(laws)
    (one, two) = figure.axes[2].patches
    c, s = np.cos(np.radians(one.get_angle())), np.sin(np.radians(one.get_angle()))
    axes = np.array([[c, -s], [s, c]]) * [one.get_width() / 2, one.get_height() / 2]
    np.testing.assert_allclose(axes @ axes.T, laws.cov, rtol=1e-6)
    assert two.get_width() == pytest.approx(2 * one.get_width())


def test_hit_gives_normal_and_tangential_parts(shot):
    for rank, hit in enumerate(shot.results.collisions, 1):
        figure = figures.hit_figure(hit, rank)
        check_layout(figure)
        state = hit.after[hit.stones[1]]
        along = state.vx * hit.normal[0] + state.vy * hit.normal[1]
        across = -state.vx * hit.normal[1] + state.vy * hit.normal[0]
        n, t = (np.hypot(0.012 * a, 0.015 * b) for a, b in (hit.normal, hit.normal[::-1]))
        said = [t.get_text() for t in texts(figure)]
        assert plus_minus(along, n) in said
        assert plus_minus(across, t) in said


def test_plan_of_stones_that_were_seen_once(shot):
    one = shot.tracks[shot.tracks["frame"] == 0]
    check_layout(figures.plan_figure(one, house=HOUSE))
    check_layout(figures.plan_figure(one, house=None))


def test_long_and_strange_names_and_close_hits_fit(shot):
    new = {"A": "red stone $x_1$ <the first one>", "B": "масса Б", "C": "_c", "D": "石"}
    tracks = shot.tracks.replace({"stone": new})
    first = shot.results.collisions[0]

    def renamed(side: dict[str, MeasuredState]) -> dict[str, MeasuredState]:
        return {new[name]: state for name, state in side.items()}

    hits = [
        dataclasses.replace(
            first,
            t=0.8 + 0.06 * k,
            stones=(new["A"], new["B"]),
            before=renamed(first.before),
            after=renamed(first.after),
        )
        for k in range(6)
    ]
    simulations = {k: v.replace({"stone": new}) for k, v in shot.simulations.items()}
    for figure in (
        figures.plan_figure(tracks, simulations, hits, house=None),
        figures.speed_figure(tracks, hits),
        figures.motion_figure(tracks, new["A"], hits),
        figures.spin_figure(tracks, new["A"], hits),
        figures.residuals_figure(residuals(shot).replace({"stone": new}), hits),
        figures.friction_figure(
            [dataclasses.replace(g, stone=new[g.stone]) for g in shot.results.glides],
            shot.results.friction,
            tracks,
        ),
        figures.comparison_figure(tracks, simulations, new["B"], hits),
        figures.hit_figure(hits[0], 1),
    ):
        check_layout(figure)


def test_close_hits_share_a_label(shot):
    hit = shot.results.collisions[0]
    hits = [dataclasses.replace(hit, t=t) for t in (0.8, 0.81, 0.83, 4.0, 6.0, 6.02)]
    figure = figures.speed_figure(shot.tracks, hits)
    check_layout(figure)
    assert [t.get_text() for t in figure.axes[0].texts] == ["1–3", "4", "5, 6"]


def test_one_wide_spot_of_a_band_does_not_squeeze_the_rest(shot):
    tracks = shot.tracks.copy()
    tracks.loc[tracks["frame"].between(38, 40), ["sd_omega", "sd_vx", "sd_x"]] = 50.0
    for figure in (
        figures.spin_figure(tracks, "B", shot.results.collisions),
        figures.motion_figure(tracks, "B", shot.results.collisions),
    ):
        for ax in figure.axes:
            assert np.ptp(ax.get_ylim()) < 6


def test_long_delivery_keeps_the_house_in_view(shot):
    tracks = shot.tracks.copy()
    thrown = tracks["stone"] == "A"
    tracks.loc[thrown, "y"] = np.linspace(30, 0.5, thrown.sum())
    figure = figures.plan_figure(tracks, house=HOUSE)
    check_layout(figure)
    low, high = figure.axes[0].get_ylim()
    assert low < -1.829
    assert 1.829 < high < 12


def test_without_a_house_the_whole_way_is_in_view(shot):
    tracks = shot.tracks[shot.tracks["stone"] == "A"].copy()
    tracks["y"] = np.linspace(30, 0.5, len(tracks))
    figure = figures.plan_figure(tracks, house=None)
    check_layout(figure)
    low, high = figure.axes[0].get_ylim()
    assert low < 0.5
    assert high > 30


def test_of_many_glides_the_legend_names_the_first(shot):
    glides = [Glide("C", 1.6 + 0.2 * k, 1.78 + 0.2 * k, 0.0109, 1e-3) for k in range(24)]
    figure = figures.motion_figure(shot.tracks, "C", shot.results.collisions, glides)
    check_layout(figure)
    said = [t.get_text() for t in figure.axes[2].get_legend().get_texts()]
    assert len(said) == 10
    assert said[-1] == "and 15 more"


def test_drawing_leaves_the_session_as_it_was(shot):
    before = dict(matplotlib.rcParams)
    with matplotlib.rc_context({"font.size": 20, "text.usetex": False, "axes.grid": False}):
        settings = dict(matplotlib.rcParams)
        svg, png = render(figures.speed_figure(shot.tracks))
        assert dict(matplotlib.rcParams) == settings
    assert dict(matplotlib.rcParams) == before
    assert svg.startswith(b"<?xml")
    assert png.startswith(b"\x89PNG")
    assert render(figures.speed_figure(shot.tracks))[0] == svg


def test_wild_sightings_are_marks_at_the_edge(shot):
    table = residuals(shot)
    table.loc[7, "dx"] = 0.5
    table.loc[9, "dy"] = -0.5
    figure = figures.residuals_figure(table, shot.results.collisions)
    check_layout(figure)
    for ax, sign, row in ((figure.axes[0], 1, 7), (figure.axes[2], -1, 9)):
        low, high = ax.get_ylim()
        assert high < 20  # mm
        (mark,) = [
            line for line in ax.lines if line.get_marker() in (6, 7) and len(line.get_xdata())
        ]
        assert list(mark.get_xdata()) == [table.loc[row, "t"]]
        assert mark.get_ydata()[0] == (high if sign > 0 else low)


def test_a_png_is_small_and_its_paper_white(shot):
    figure = figures.plan_figure(shot.tracks, shot.simulations, house=HOUSE)
    _, png = render(figure)
    assert len(png) < 100_000
    picture = Image.open(BytesIO(png))
    wide, high = (int(size * PNG_DPI) for size in figure.get_size_inches())
    assert picture.size == (wide, high)
    colours = picture.convert("RGB").getcolors()
    assert colours is not None
    assert max(colours)[1] == (255, 255, 255)
    true = np.asarray(picture.convert("RGB"), int)
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(PNG_DPI)
    canvas.draw()
    off = np.abs(true - np.asarray(canvas.buffer_rgba())[:, :, :3])
    assert off.mean() < 1.5  # of 255
