from __future__ import annotations

import pytest

from curlshot.data.messages import COMMANDS, OPTIONS, as_options, as_settings


@pytest.mark.parametrize("name", sorted({*OPTIONS, *COMMANDS}))
def test_the_spelling_of_the_command_line_is_turned_back(name: str) -> None:
    text = f"give it (`{name}`), or `{name}`: 3; see `{name}`"
    assert "`" not in as_options(text)
    assert as_settings(as_options(text)) == text


@pytest.mark.parametrize("text", ["clip--fps.mp4", "--fpsx", "--no-fps", "a-o", "my curlshot runs"])
def test_what_is_no_option_stays(text: str) -> None:
    assert as_settings(text) == text
