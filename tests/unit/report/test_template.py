from __future__ import annotations

import os
from pathlib import Path

import pytest

from curlshot.report.template import link


def test_a_link_leads_to_names_of_all_letters_and_of_none(tmp_path: Path) -> None:
    folder = tmp_path / "out #1"
    assert link(tmp_path / "50% ü" / "a?b.html", folder) == "../50%25%20%C3%BC/a%3Fb.html"
    # Linux has names that are no text.
    assert link(tmp_path / "\udcff" / "x.html", folder).endswith("/x.html")


def test_a_link_to_another_drive_is_the_whole_address(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def relpath(*_: object) -> str:
        raise ValueError("path is on mount 'C:', start on mount 'D:'")

    monkeypatch.setattr(os.path, "relpath", relpath)
    there = tmp_path / "a b" / "report.html"
    assert link(there, tmp_path / "out") == there.resolve().as_uri()
