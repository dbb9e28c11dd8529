"""The examples, run as a reader would run them, on one run of the bundled sample."""

from __future__ import annotations

import re
import runpy
import shlex
import sys
from pathlib import Path

import matplotlib
import pytest

from curlshot.cli.parser import command_line
from curlshot.outcome import Run

ROOT = Path(__file__).resolve().parents[2]
QUICKSTART = ROOT / "examples" / "quickstart.ipynb"
MOST_OF_A_NOTEBOOK = 20_000
DOCS = sorted((ROOT / "docs").glob("*.md"))
OF_A_RUN = ("coach", "figures", "from_tracks", "shared", "what_if")


def said(name: str, capsys: pytest.CaptureFixture[str], *words: Path) -> str:
    path = ROOT / "examples" / f"{name}.py"
    before, sys.argv = sys.argv, [str(path), *map(str, words)]
    try:
        runpy.run_path(str(path), run_name="__main__")
    finally:
        sys.argv = before
    return capsys.readouterr().out


def test_every_example_is_run() -> None:
    names = {path.stem for path in (ROOT / "examples").glob("*.py")}
    assert names == {*OF_A_RUN, "from_a_clip", "simulate"}


@pytest.mark.parametrize("name", ["coach", "figures", "what_if"])
def test_an_example_of_a_run_asks_for_one(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        said(name, capsys)
    assert capsys.readouterr().err.startswith(f"usage: python examples/{name}.py RUN")


def test_from_a_clip(capsys: pytest.CaptureFixture[str]) -> None:
    text = said("from_a_clip", capsys)
    assert "A hit B at 1.12" in text
    e = float(text.split("e = ")[1].split()[0])
    assert e == pytest.approx(0.8345, abs=0.05)


def test_from_tracks(sample: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert sample.out is not None
    for words in ((), (sample.out,)):
        text = said("from_tracks", capsys, *words)
        assert "('A', 'B')" in text
        assert "B leaves with" in text


def test_shared(sample: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert sample.out is not None
    number = r"e = (\S+) ± (\S+)"
    for words, true, shots in (((), 0.83, 2), ((sample.out,), 0.8345, 1)):
        found = re.findall(number, said("shared", capsys, *words))
        *alone, (e, sd) = [(float(value), float(stderr)) for value, stderr in found]
        assert len(alone) == shots
        assert abs(e - true) < 3 * sd
        assert sd < 1.05 * min(stderr for _, stderr in alone)


def test_simulate(capsys: pytest.CaptureFixture[str]) -> None:
    text = said("simulate", capsys)
    assert text.count("A on B") == 3


def test_coach(sample: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert sample.out is not None
    text = said("coach", capsys, sample.out)
    assert "ft/s" in text
    assert " m/s" not in text
    assert "first detected 12.8 ft past it" in text
    assert "shot stone: B" in text
    assert "B: 2.2 ft from the tee" in text
    assert "nan" not in text


def test_the_notebook_runs_from_top_to_bottom(tmp_path: Path) -> None:
    nbclient = pytest.importorskip("nbclient")
    notebook = pytest.importorskip("nbformat").read(QUICKSTART, as_version=4)
    assert QUICKSTART.stat().st_size < MOST_OF_A_NOTEBOOK
    assert not any(cell.get("outputs") for cell in notebook.cells)
    nbclient.NotebookClient(
        notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert any("<svg" in output.get("data", {}).get("text/html", "") for output in shown)
    assert sum("image/png" in output.get("data", {}) for output in shown) >= 3


def test_what_if(sample: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert sample.out is not None
    text = said("what_if", capsys, sample.out)
    assert "5 cm to the left" in text
    # Whether the third stone moves most of the time depends on the aim.
    assert text.count("A: in the house") == text.count("B: in the house") == 3


def test_figures(sample: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sample.out is not None
    matplotlib.use("agg")
    text = said("figures", capsys, sample.out, tmp_path)
    assert "closing_speed" in text
    names = {"my_plan.pdf", "my_motion.pdf", "my_comparison.pdf", "my_hit.png", "my_pair.pdf"}
    assert {path.name for path in tmp_path.iterdir()} == names


def test_the_picture_of_the_readme_is_small_and_can_be_made(sample: Run) -> None:
    assert sample.out is not None
    made = runpy.run_path(str(ROOT / "docs" / "picture.py"))["picture"](sample.out)
    assert made.width > 1.6 * made.height
    kept = ROOT / "docs" / "result.png"
    assert kept.stat().st_size < 300_000
    assert "docs/result.png" in (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["README.md", *sorted(f"docs/{p.name}" for p in DOCS)])
def test_links_of_the_documents_lead_somewhere(name: str) -> None:
    path = ROOT / name
    links = re.findall(r"\]\(([^)#]+)", path.read_text(encoding="utf-8"))
    broken = [k for k in links if "://" not in k and not (path.parent / k).exists()]
    assert not broken


@pytest.mark.parametrize("name", ["README.md", "docs/tutorial.md", "docs/tracker.md"])
def test_commands_in_the_documents_are_known(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    parser = command_line("")
    blocks = re.findall(r"^```\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    commands = [re.split(r"\s{3,}", line)[0] for line in lines if line.startswith("curlshot ")]
    assert commands
    for command in commands:
        parser.parse_args(shlex.split(command)[1:])
