from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

from curlshot.cli.main import WORK
from curlshot.cli.parser import command_line
from curlshot.physics.registry import FAMILIES, models, parameters_of
from curlshot.physics.simulator.shot import read_shot
from curlshot.physics.simulator.simulation import StoneStart


def said(capsys, *words: str) -> tuple[int, str]:
    with pytest.raises(SystemExit) as left:
        command_line("1.0").parse_args(words)
    out = capsys.readouterr()
    return int(left.value.code or 0), out.out + out.err


def test_there_is_a_parser_for_every_work(capsys) -> None:
    for command in WORK:
        code, text = said(capsys, command, "--help")
        assert (code, text.split()[:3]) == (0, ["usage:", "curlshot", command])


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ((), "COMMAND"),
        (("walk",), "walk"),
        (("track",), "CLIP"),
        (("run", "a.mp4", "--fps", "0"), "--fps: '0' is not a positive number"),
        (("run", "a.mp4", "--frames", "3"), "FIRST:LAST"),
        (("run", "a.mp4", "--frames", "-5:-1"), "'-5:-1' is not FIRST:LAST"),
        (("run", "a.mp4", "--fiction", "1"), "run: unrecognized arguments: --fiction 1, did you"),
        (("run", "a.mp4", "--fiction=1"), "did you mean --friction? (see curlshot run --help)"),
        (("check", "a.mp4", "--zoom"), "unrecognized arguments: --zoom (see curlshot check"),
        (("simulate", "a.toml", "--speed", "-2x"), "'-2x' is not a speed above 0"),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(capsys, words, part: str) -> None:
    code, text = said(capsys, *words)
    assert code == 2
    assert text.count("\n") == 1
    assert part in text and "--help" in text


def test_a_factor_may_be_negative() -> None:
    parsed = command_line("1.0").parse_args(["simulate", "a.toml", "--spin", "-1x"])
    assert (parsed.spin.value, parsed.spin.relative) == (-1.0, True)


def test_the_version_is_told(capsys) -> None:
    assert said(capsys, "--version") == (0, "curlshot 1.0\n")


def test_inputs_come_in_the_order_they_were_named() -> None:
    parsed = command_line("1.0").parse_args(["run", "b.txt", "a.txt", "--mass", "A=2"])
    assert [str(name) for name in parsed.inputs] == ["b.txt", "a.txt"]
    assert parsed.masses == [("A", 2.0)]


def test_the_help_of_simulate_has_a_shot_with_every_key(capsys, tmp_path: Path) -> None:
    text = said(capsys, "simulate", "--help")[1]
    example = text[text.index("  [physics]\n") :]
    (tmp_path / "SHOT.toml").write_text(example)
    assert [stone.name for stone in read_shot(tmp_path / "SHOT.toml").stones] == ["A"]
    laws = [law for family in FAMILIES for law in models(family).values()]
    keys = {item.name for law in laws for item in parameters_of(law)}
    keys |= {item.name for item in fields(StoneStart)} | {"model", "ice", "curl", "radius", "sheet"}
    assert not keys - set(re.findall(r"\w+", example))
