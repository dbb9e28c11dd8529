from __future__ import annotations

import time
from pathlib import Path

import pytest

from curlshot.data.errors import InputError
from curlshot.tests.helpers.data.delimited import read

MEGABYTE = 1_000_000


@pytest.mark.parametrize(
    "text",
    [
        "9" * MEGABYTE + "x",
        "t,x,y\n" + "9" * MEGABYTE + ",1,1\n",
        "t,x,y\n0,1," + "9" * MEGABYTE + "x\n",
        "t,x,y\n0,1," + " " * MEGABYTE + "×\n",
        "t," + "(" * MEGABYTE + "\n0,1\n",
        "t" + " " * MEGABYTE + "x\n0,1\n",
        't,"' + "x" * MEGABYTE + "\n0,1\n",
        "t," + "x," * MEGABYTE + "\n0,1\n",
        "," * MEGABYTE,
        "\n" * MEGABYTE,
    ],
    ids=range(10),
)
def test_giant_cells_take_no_time(tmp_path: Path, text: str) -> None:
    start = time.process_time()
    try:
        read(tmp_path, text).numbers([0, 1])
    except InputError as refusal:
        assert len(str(refusal)) < 400
    assert time.process_time() - start < 5
