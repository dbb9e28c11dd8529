"""The page as people use it: played, scrubbed, dragged and read, in Chromium without a network."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from curlshot.config import VideoConfig
from curlshot.data.results import NotedEstimate, Results
from curlshot.data.sheet import HOUSE
from curlshot.physics.curl import FCV1Curl
from curlshot.physics.ice import FCV1
from curlshot.physics.impact import Frictional, PointMass, RigidBody
from curlshot.physics.prediction.start import Start, measured_start
from curlshot.physics.prediction.what_if import Amount, Changes, changed
from curlshot.physics.simulator.shot import read_shot
from curlshot.physics.simulator.simulate import simulate
from curlshot.physics.simulator.simulation import Shot as Throw
from curlshot.report.overlay import write_overlay
from curlshot.report.page import write_report
from curlshot.tests.helpers.report.browser import Browser, Tab, needs_chromium
from curlshot.tests.helpers.report.clips import camera, pictures
from curlshot.vision.video.reader import open_video

pytestmark = needs_chromium

MILLIMETRE = 1e-3
CONTRAST = 4.5
"""Least contrast of text, Web Content Accessibility Guidelines 2.2, level AA."""

PLACE = """(() => {
  const unit = 14.55 / player.data.radius;
  return Object.fromEntries(player.drawn.map(({ stone, drawn }) => {
    const m = drawn.group.transform.baseVal.consolidate()?.matrix;
    const shown = drawn.group.style.display !== 'none';
    return [stone.name, shown ? [m.e / unit, -m.f / unit] : null];
  }));
})()"""
OUTCOME = (
    "Object.fromEntries(whatIf.rest.map((s, k) => [whatIf.data.shot.stones[k].name, [s.x, s.y]]))"
)
CONTRASTS = """(() => {
  const parse = (text) => text.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((v) => v / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = parse(getComputedStyle(e).backgroundColor);
      if (colour.length < 4 || colour[3] > 0.99) return colour;
    }
    return [255, 255, 255];
  };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const e = walker.currentNode.parentElement, text = walker.currentNode.data.trim();
    if (!text || e.closest('svg, script') || !e.checkVisibility()) continue;
    const [a, b] = [light(parse(getComputedStyle(e).color)), light(behind(e))];
    found.push([(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), text]);
  }
  return found;
})()"""


@pytest.fixture(scope="module")
def results(shot) -> Results:
    """What was found, with a curl that no law has by itself."""
    return dataclasses.replace(shot.results, curl=NotedEstimate(0.006, 0.001))


@pytest.fixture(scope="module")
def page(tmp_path_factory, shot, results) -> Path:
    folder = tmp_path_factory.mktemp("browser")
    frames = tmp_path_factory.mktemp("frames")
    clip = open_video(pictures(frames, 50), VideoConfig(fps=25.0))
    start = write_overlay(clip, [camera(0)], shot.tracks, (), folder / "overlay.mp4")
    return write_report(
        folder,
        results=results,
        tracks=shot.tracks[shot.tracks["frame"] < 50],
        simulations={name: t[t["frame"] < 50] for name, t in shot.simulations.items()},
        house=HOUSE,
        overlay=folder / "overlay.mp4",
        clip_start=start,
        ensemble=shot.ensemble,
    )


@pytest.fixture(scope="module")
def opened(browser: Browser, page: Path) -> Iterator[Tab]:
    with browser.tab() as tab:
        tab.open(page)
        tab.wait("document.querySelector('#clip').readyState >= 2")
        yield tab


@pytest.fixture
def tab(opened: Tab) -> Iterator[Tab]:
    """Give the page as it is at first; nothing may complain."""
    opened.media()
    opened.size(1440, 900)
    opened.value("document.activeElement.blur(), player.setRate(1), player.seek(0), null")
    opened.value("whatIf.reset(), null")
    yield opened
    opened.value("player.pause(), null")
    assert opened.complaints == []


@pytest.fixture(scope="module")
def start(shot, results) -> Start:
    return measured_start(shot.tracks[shot.tracks["frame"] < 50], results, shot.ensemble)


def rest(throw: Throw) -> dict[str, tuple[float, float]]:
    return {name: (r.x, r.y) for name, r in simulate(throw).rest.items()}


def assert_alike(seen: dict[str, list[float]], expected: dict[str, tuple[float, float]]) -> None:
    assert seen.keys() == expected.keys()
    for name, place in expected.items():
        assert np.hypot(*np.subtract(seen[name], place)) <= MILLIMETRE, name


def assert_shows(tab: Tab, shot, rank: int) -> None:
    rows = shot.tracks[shot.tracks["frame"] == rank]
    expected = {row.stone: (row.x, row.y) for row in rows.itertuples()}
    assert_alike(tab.value(PLACE), expected)


def test_clip_and_plan_play_in_step(tab, shot):
    tab.click("#play")
    tab.wait("player.rank > 5 && document.querySelector('#clip').currentTime > 0.2")
    tab.press(" ")
    tab.wait("!player.playing")
    rank = tab.value("player.rank")
    assert 5 < rank < 50
    # The picture that is shown is at most a frame ahead of the latest that was told.
    assert tab.value("document.querySelector('#clip').currentTime") == pytest.approx(
        rank / 25, abs=0.09
    )
    assert_shows(tab, shot, rank)
    assert tab.value("document.querySelector('#play').getAttribute('aria-label')") == "Play"


def test_it_ends_and_begins_again(tab):
    tab.value("player.setRate(2), player.seek(44), null")
    tab.press(" ")
    tab.wait("!player.playing && player.rank >= 48")
    tab.press(" ")
    tab.wait("player.playing && player.rank < 30")
    tab.value("player.pause(), null")


def test_scrubbing_and_keys_step_through_the_frames(tab, shot):
    tab.value(
        "(() => { const s = document.querySelector('#scrub'); s.value = 30;"
        "s.dispatchEvent(new Event('input')); })()"
    )
    assert_shows(tab, shot, 30)
    tab.wait("Math.abs(document.querySelector('#clip').currentTime - 30.5 / 25) < 0.01")
    for key, rank in ((".", 31), (".", 32), (",", 31), ("ArrowLeft", 18), ("End", 49), ("Home", 0)):
        tab.press(key)
        assert tab.value("player.rank") == rank, key
        assert_shows(tab, shot, rank)
    assert tab.value("document.querySelector('#scrub').getAttribute('aria-valuetext')") == (
        "0.00 seconds, frame 0"
    )


def test_hits_flash_and_models_can_be_chosen(tab, shot):
    hit = shot.results.collisions[0]
    flash = "document.querySelector('.hit .flash').getAttribute('r') > 0"
    tab.value(f"player.seek({int(hit.t * 25) - 1}), null")
    assert tab.value("document.querySelector('.hit').style.display") == "none"
    tab.value(f"player.seek({int(hit.t * 25) + 2}), null")
    assert tab.value(flash)
    assert tab.value("document.querySelector('#model').value") == "frictional"
    tab.value("player.choose('point-mass'), null")
    model = shot.simulations["point-mass"].query("stone == 'B' and frame == 22").iloc[0]
    tab.value("player.seek(22), null")
    x, y = tab.value(
        "(() => { const m = player.ghosts.get('B')[1].group.transform.baseVal.consolidate().matrix;"
        "const unit = 14.55 / player.data.radius; return [m.e / unit, -m.f / unit]; })()"
    )
    assert np.hypot(x - model.x, y - model.y) <= MILLIMETRE


def pick(tab: Tab, element: str, value: object) -> None:
    """Choose a value of a control."""
    tab.value(
        f"(() => {{ const s = document.querySelector('#whatif-{element}');"
        f"s.value = {json.dumps(value)}; s.dispatchEvent(new Event('input')); }})()"
    )


def test_without_a_change_it_is_the_measured_shot(tab, start):
    assert_alike(tab.value(OUTCOME), rest(start.shot))


@pytest.mark.parametrize(
    ("slider", "number", "changes"),
    [
        ("restitution", 0.5, Changes(restitution=0.5)),
        ("friction", 0.0065, Changes(friction=0.0065)),
        ("speed", 2.25, Changes(speed=Amount(2.25))),
        ("aim", -7.5, Changes(aim_offset=-0.075)),
        ("spin", -3.0, Changes(spin=Amount(-3.0))),
    ],
)
def test_a_slider_changes_the_outcome_as_python_says(tab, start, slider, number, changes):
    pick(tab, slider, number)
    assert_alike(tab.value(OUTCOME), rest(changed(start, changes).shot))
    tab.click("#whatif-reset")
    assert_alike(tab.value(OUTCOME), rest(start.shot))


def test_laws_and_models_are_those_of_python(tab, start):
    impact = start.shot.impact
    assert isinstance(impact, Frictional)
    pick(tab, "rub", 0.3)
    rough = dataclasses.replace(start.shot, impact=dataclasses.replace(impact, stone_friction=0.3))
    assert_alike(tab.value(OUTCOME), rest(rough))
    pick(tab, "ice", "fcv1")
    pick(tab, "curl", "fcv1")
    other = dataclasses.replace(rough, ice=FCV1(), curl=FCV1Curl())
    assert_alike(tab.value(OUTCOME), rest(other))
    pick(tab, "model", "point-mass")
    plain = dataclasses.replace(other, impact=PointMass(impact.restitution))
    assert_alike(tab.value(OUTCOME), rest(plain))
    pick(tab, "model", "rigid-body")
    # As in the tables: 0.4 rad/s after it hits, 0.3 after it is hit, and unhit its own.
    spins = {"A": (0.4,), "B": (0.3, 0.4), "C": (0.3,), "D": (0.0,)}
    stones = tuple(dataclasses.replace(s, omega_after=spins[s.name]) for s in other.stones)
    rigid = dataclasses.replace(other, stones=stones, impact=RigidBody(impact.restitution))
    assert_alike(tab.value(OUTCOME), rest(rigid))


def test_no_line_breaks_within_what_is_to_be_typed(tab):
    tab.value("document.body.style.maxWidth = '360px', null")
    pieces = tab.value(
        "[...document.querySelectorAll('p code')].map(c => c.getClientRects().length)"
    )
    tab.value("document.body.style.maxWidth = '', null")
    assert set(pieces) == {1}


def test_the_throw_runs_and_comes_back(tab, start):
    y = "-whatIf.drawn[0].start.group.transform.baseVal.consolidate().matrix.f"
    scale = 14.55 / start.shot.radius
    begun = start.shot.stones[start.thrown].y * scale
    tab.click("#whatif-run")
    tab.wait(f"{y} < {begun - 20}")
    pick(tab, "restitution", 0.7)
    tab.wait(f"Math.abs({y} - {begun}) < 0.1")


def placed(tab: Tab, start: Start) -> Throw:
    """Return the shot with the stones where they are in the page."""
    places = tab.value("whatIf.places")
    stones = zip(start.shot.stones, places, strict=True)
    moved = tuple(dataclasses.replace(stone, x=x, y=y) for stone, (x, y) in stones)
    return dataclasses.replace(start.shot, stones=moved)


def test_a_stone_dragged_by_mouse_finger_or_keys_changes_the_outcome(tab, start):
    held = "[data-held='B']"
    before = tab.value("whatIf.places")
    x, y = tab.middle(f"{held} .body")
    tab.drag((x, y), (x + 21, y - 13))
    unit = tab.value("whatIf.plan.svg.getScreenCTM().a") * 14.55 / start.shot.radius
    after = tab.value("whatIf.places")
    k = [stone.name for stone in start.shot.stones].index("B")
    np.testing.assert_allclose(np.subtract(after[k], before[k]), [21 / unit, 13 / unit], atol=1e-4)
    assert_alike(tab.value(OUTCOME), rest(placed(tab, start)))
    for _ in range(3):
        tab.press("ArrowLeft")
    tab.press("ArrowUp", shift=True)
    np.testing.assert_allclose(
        np.subtract(tab.value("whatIf.places")[k], after[k]), [-0.03, 0.001], atol=1e-9
    )
    assert_alike(tab.value(OUTCOME), rest(placed(tab, start)))
    x, y = tab.middle("[data-held='D'] .body")
    tab.swipe((x, y), (x + 15, y + 9))
    assert tab.value("whatIf.places") != after
    assert_alike(tab.value(OUTCOME), rest(placed(tab, start)))


def test_stones_cannot_be_dragged_into_each_other(tab, start):
    first, second = tab.middle("[data-held='C'] .body"), tab.middle("[data-held='D'] .body")
    tab.drag(first, second)
    places = np.array(tab.value("whatIf.places"))
    apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    assert apart[np.triu_indices(len(places), 1)].min() >= 2 * start.shot.radius


def test_the_copied_shot_is_the_one_shown(tab, tmp_path):
    pick(tab, "friction", 0.012)
    tab.click("#whatif-copy")
    path = tmp_path / "SHOT.toml"
    path.write_text(tab.value("document.querySelector('#whatif-toml').value"), encoding="utf-8")
    assert_alike(tab.value(OUTCOME), rest(read_shot(path)))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_can_be_read(tab, scheme):
    tab.media("screen", scheme)
    contrasts = tab.value(CONTRASTS)
    assert len(contrasts) > 100
    assert [text for ratio, text in contrasts if ratio < CONTRAST] == []


def test_all_that_can_be_used_has_a_name(tab):
    nodes = tab.send("Accessibility.getFullAXTree")["nodes"]
    used = {"button", "slider", "combobox", "image", "link", "textbox", "Video"}
    named = [
        (node["role"]["value"], node.get("name", {}).get("value"))
        for node in nodes
        if not node["ignored"] and node.get("role", {}).get("value") in used
    ]
    assert len(named) > 20
    assert [role for role, name in named if not name] == []


@pytest.mark.parametrize("width", [390, 1440])
def test_it_fits_the_window(tab, width):
    tab.size(width, 900)
    assert tab.value("document.documentElement.scrollWidth") <= width


def test_print_has_figures_and_no_buttons(tab):
    tab.media("print")
    assert not tab.value("document.querySelector('#player').checkVisibility()")
    assert not tab.value("document.querySelector('#whatif').checkVisibility()")
    assert tab.value("document.querySelector('#figure-plan img').checkVisibility()")


def test_without_its_clip_the_plan_plays_alone(browser, page, tmp_path, shot):
    lone = tmp_path / "report.html"
    lone.write_bytes(page.read_bytes())
    with browser.tab() as tab:
        tab.open(lone)
        tab.wait("player.video === null")
        assert "overlay.mp4" in tab.value("document.querySelector('#clip-missing').innerText")
        tab.press(" ")
        tab.wait("player.rank > 3")
        tab.press(" ")
        assert_shows(tab, shot, tab.value("player.rank"))


def test_a_simulation_gone_astray_leaves_the_measured_shot_in_sight(browser, tmp_path, shot):
    """As of a disc that a wall turned back, which no model knows of."""
    width = []
    for aside in (0.0, 40.0):
        simulations = {model: t.copy() for model, t in shot.simulations.items()}
        for table in simulations.values():
            table["x"] += aside * (table["stone"] == "A")
        page = write_report(
            tmp_path, results=shot.results, tracks=shot.tracks, simulations=simulations, house=None
        )
        with browser.tab() as tab:
            tab.open(page)
            width.append(tab.value("player.plan.svg.viewBox.baseVal.width"))
            assert tab.complaints == []
    assert width[0] < width[1] < 1.5 * width[0]


def test_a_still_picture_has_a_page_too(browser, tmp_path, shot):
    still = shot.tracks[shot.tracks["frame"] == 0].assign(vx=np.nan, vy=np.nan, omega=np.nan)
    results = dataclasses.replace(
        shot.results,
        collisions=(),
        glides=(),
        simulations={},
        joint_estimate=None,
        warnings=("one picture",),
    )
    page = write_report(tmp_path, results=results, tracks=still, simulations={}, house=HOUSE)
    with browser.tab() as tab:
        tab.open(page)
        assert_shows(tab, shot, 0)
        tab.press(" ")
        tab.press(".")
        assert tab.value("player.rank") == 0
        assert tab.value("document.querySelector('#whatif')") is None
        assert tab.complaints == []


def test_names_are_never_run(browser, tmp_path, shot):
    evil = "</script><script>window.ran=1</script><img src=x onerror='window.ran=1'>"
    tracks = shot.tracks.replace({"stone": {"B": evil}})
    collisions = tuple(
        dataclasses.replace(
            hit,
            stones=tuple(evil if name == "B" else name for name in hit.stones),
            before={evil if name == "B" else name: s for name, s in hit.before.items()},
            after={evil if name == "B" else name: s for name, s in hit.after.items()},
        )
        for hit in shot.results.collisions
    )
    results = dataclasses.replace(shot.results, collisions=collisions, simulations={})
    likely = shot.ensemble.likely
    stones = tuple(dataclasses.replace(s, name=evil) if s.name == "B" else s for s in likely.stones)
    ensemble = dataclasses.replace(shot.ensemble, likely=dataclasses.replace(likely, stones=stones))
    page = write_report(
        tmp_path, results=results, tracks=tracks, simulations={}, house=HOUSE, clip_name=evil,
        ensemble=ensemble,
    )  # fmt: skip
    with browser.tab() as tab:
        tab.open(page)
        assert tab.value("document.title").startswith(evil)
        assert tab.value("window.ran") is None
        assert evil in tab.value("whatIf.data.shot.stones.map((s) => s.name)")
        assert tab.complaints == []


def test_data_are_compact(page, shot):
    text = page.read_text(encoding="utf-8")
    raw = re.search(r'id="shot-data">(.*?)</script>', text, re.DOTALL)
    assert raw is not None
    rows = int((shot.tracks["frame"] < 50).sum()) * (1 + len(shot.simulations))
    assert len(raw[1]) / rows < 40
    json.loads(raw[1])
    assert len(text) < 3_000_000
