"""The page of a season, and its tables sorted in Chromium."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from curlshot.cli.main import main
from curlshot.data.results import Estimate, Results
from curlshot.data.results_file import write_results
from curlshot.tests.helpers.report.browser import Browser, needs_chromium
from curlshot.tests.helpers.report.page import Page
from curlshot.tests.helpers.report.shots import BARE, SHOT

NAMES = {"a < b": 0.82, "shot 2": 0.79, "shot 10": 0.91, "early": None}
"""Of shots, and what their e is."""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("season")
    bare = replace(BARE, warnings=("restitution: no hit detected",))
    for name, value in NAMES.items():
        shot: Results = bare if value is None else replace(SHOT, restitution=Estimate(value, 0.01))
        write_results(shot, folder / "runs" / name / "results.json")
        if name != "shot 2":
            (folder / "runs" / name / "report.html").write_text("<p>its own</p>", "utf-8")
    write_results(replace(SHOT, restitution=Estimate(0.79, 0.01)), folder / "runs/zz/results.json")
    assert main(["season", str(folder / "runs"), "-o", str(folder / "out")]) == 0
    return folder / "out" / "season.html"


def test_it_says_what_all_shots_say_and_leads_to_each(written: Path) -> None:
    page = Page(written)
    assert page.tags[0] == ("html", {"lang": "en-GB"})
    assert "mean of 3 shots; scatter from shot to shot" in page.said
    assert "zz: the same shot as shot 2: counted once" in page.said
    assert "restitution: no hit detected" in page.said
    addresses = [address["href"] or "" for address in page.all("a")]
    reports = {written.parent / address.replace("%20", " ") for address in addresses}
    assert all(path.exists() or "%3C" in str(path) for path in reports)
    assert any("a%20%3C%20b/report.html" in address for address in addresses)
    assert not any("shot%202/" in address for address in addresses)
    assert [image["src"] for image in page.all("img")] == ["season.png"]
    assert (written.parent / "season.png").exists()
    values = {value for value, _ in page.numbers}
    assert {0.82, 0.79, 0.91, 0.01} <= values


@needs_chromium
def test_a_click_on_a_head_sorts_by_it(browser: Browser, written: Path) -> None:
    rows = "[...document.querySelectorAll('#shots ~ .scroll tbody tr')]"
    names = f"{rows}.map(row => row.cells[0].innerText)"
    with browser.tab() as tab:
        tab.open(written)
        tab.click("#shots ~ .scroll th:nth-child(3) button")
        assert tab.value(names) == ["shot 2", "a < b", "shot 10", "early"]
        tab.click("#shots ~ .scroll th:nth-child(3) button")
        assert tab.value(names) == ["shot 10", "a < b", "shot 2", "early"]
        tab.click("#shots ~ .scroll th:nth-child(1) button")
        assert tab.value(names) == ["a < b", "early", "shot 2", "shot 10"]
        tab.size(380, 800)
        assert tab.value("document.documentElement.scrollWidth <= innerWidth")
        assert tab.complaints == []
