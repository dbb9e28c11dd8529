from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from curlshot.cli.arguments import config_of
from curlshot.cli.parser import command_line
from curlshot.config import Config
from curlshot.report.command_line import MOST_FILES, command_of


def words(files: list[Path], settings: Config) -> list[str]:
    return shlex.split(command_of(files, settings))


@pytest.mark.parametrize(
    "settings",
    [
        Config(),
        Config().replace(
            fps=29.97, frames=(2, 31), stick=(20.0, 36.0, 20.0, 220.0, 0.5), radius=0.0465
        ),
        Config().replace(frames=(5, None), house=(12, 640.0, 360.0, 460.0, 360.5, 640.0, 180.0)),
        Config().replace(house=(None, 640.0, 360.0, 460.0, 360.5, 640.0, 180.0), overlay=False),
        Config().replace(camera=Path("earlier run/camera.csv"), units="ft"),
        Config().replace(
            masses={"A": 19.1, "B": 18.0}, length_unit="cm", angle_unit="deg", tab="it's"
        ),
        Config().replace(names={"A": "mass A"}, angles={"A": Path("a b.txt")}, restitution=0.8),
        Config().replace(friction=0.012, clip=True, camera_height=5.6),
    ],
)
def test_the_same_settings_come_back(settings):
    said = words([Path("/somewhere/my shot.mp4")], settings)
    assert said[:3] == ["curlshot", "run", "my shot.mp4"]
    arguments = command_line("1.0").parse_args(said[1:])
    assert config_of(arguments) == settings


def test_what_only_a_file_can_set_is_in_the_file_of_the_run():
    said = words([Path("shot.mp4")], Config().replace(min_evidence=1.2, fps=25.0))
    assert said == ["curlshot", "run", "shot.mp4", "--fps", "25.0", "--config", "config.toml"]


def test_many_pictures_are_named_by_their_folder():
    files = [Path(f"/clips/take 7/{k:03}.png") for k in range(MOST_FILES + 1)]
    assert words(files, Config()) == ["curlshot", "run", "take 7/"]
