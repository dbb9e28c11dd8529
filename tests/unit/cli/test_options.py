from __future__ import annotations

import argparse
import shlex

import pytest

from curlshot.cli import options
from curlshot.cli.arguments import config_of
from curlshot.cli.parser import command_line


def parsed(add, words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add(parser)
    return parser.parse_args(shlex.split(words))


@pytest.mark.parametrize(
    "add",
    [
        options.radius_option, options.mass_option, options.clip_options, options.what_if_options,
        options.assumption_options, options.units_option, options.tab_option,
        options.table_options,
    ],
)  # fmt: skip
def test_every_option_has_a_default_and_says_what_it_is(add) -> None:
    parser = argparse.ArgumentParser()
    add(parser)
    parser.parse_args([])
    for action in parser._actions:
        assert action.help and len(action.help) > 3, action.dest


def test_what_is_not_given_is_left_to_the_configuration() -> None:
    assert parsed(options.radius_option, "").radius is None  # as the configuration has it
    assert parsed(options.mass_option, "").masses is None
    assert parsed(options.what_if_options, "").aim_offset == 0.0


def test_options_that_name_stones_add_up() -> None:
    names = parsed(options.table_options, '--names A="mass A" --names "B=mass = B"').names
    assert names == [("A", "mass A"), ("B", "mass = B")]
    assert parsed(options.mass_option, "--mass A=18 --mass B=19").masses == [("A", 18), ("B", 19)]


def test_the_defaults_of_the_command_are_those_of_the_library() -> None:
    from curlshot.config import Config

    assert config_of(command_line("1.0").parse_args(["run", "a.mp4"])) == Config()
