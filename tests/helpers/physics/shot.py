"""What tests of shot share."""

from __future__ import annotations

from pathlib import Path

from curlshot.physics.simulator.shot import read_shot
from curlshot.physics.simulator.simulation import Shot


def read(folder: Path, text: str) -> Shot:
    path = folder / "SHOT.toml"
    path.write_text(text, encoding="utf-8")
    return read_shot(path)
