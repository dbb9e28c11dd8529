"""What tests of delimited share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from curlshot.data.delimited import TextTable, read_text_table


def is_header(names: Sequence[str]) -> bool:
    return names[0] == "t" and len(names) > 1


def read(folder: Path, text: str | bytes) -> TextTable:
    path = folder / "table.txt"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_text_table(path, is_header)
