"""Pages from their templates: what any of them may use."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from curlshot.report.cells import data, data_parts, data_significant
from curlshot.report.numbers import assumed, count

WEB = Path(__file__).parent / "web"


def environment() -> Environment:
    """Give what makes pages of templates in ``web``, with numbers written as people read them."""
    made = Environment(
        loader=FileSystemLoader(WEB),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["number"] = data
    made.filters["significant"] = data_significant
    made.globals.update(pair=data_parts, count=count, assumed=assumed)
    return made


def source(name: str) -> Markup:
    """Give a style sheet or a script, to stand in a page."""
    return Markup((WEB / name).read_text(encoding="utf-8").rstrip())


def link(path: Path, folder: Path) -> str:
    """Give the address of a file for a page in a folder; the whole one from another drive."""
    try:
        way = os.path.relpath(path, folder)
    except ValueError:
        return path.resolve().as_uri()
    return quote(os.fsencode(Path(way).as_posix()))
