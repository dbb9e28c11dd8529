from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from curlshot import pipeline
from curlshot.cli.arguments import config_of
from curlshot.cli.main import main
from curlshot.cli.parser import command_line
from curlshot.config import Config, measures_clip, refuse_clip_settings, refuse_table_settings
from curlshot.data.errors import InputError
from curlshot.data.messages import OPTIONS


def test_a_tab_is_refused_where_nothing_has_tabs() -> None:
    with pytest.raises(InputError, match="only tables take `tab`, `length_unit`"):
        refuse_table_settings(Path("shot.mp4"), Config().replace(tab="a", length_unit="cm"))
    with pytest.raises(InputError, match="only tables take `names`"):
        refuse_table_settings(Path("shot.trz"), Config().replace(names={"A": "mass A"}, tab="a"))


def test_settings_of_a_preset_that_do_not_fit_are_ignored() -> None:
    text = "[video]\nclip = true\n[camera]\ncamera_height = 6.4\n[tables]\nno_house = true"
    preset = Config.from_text(text)
    clip, table = Path("shot.mp4"), Path("tracks.csv")
    refuse_clip_settings(table, preset.replace(radius=0.1))
    refuse_table_settings(clip, preset.replace(radius=0.1))
    with pytest.raises(InputError, match="only clips take `camera_height`; tracks"):
        refuse_clip_settings(table, preset.replace(camera_height=6.4))
    with pytest.raises(InputError, match="only tables take `angle_unit`; a clip"):
        refuse_table_settings(clip, preset.replace(angle_unit="deg"))
    assert measures_clip([Path("shot.trk")], preset) and not measures_clip([table], preset)
    assert measures_clip([table], Config().replace(clip=True))


def test_a_project_has_tabs_as_a_clip_and_as_a_camera() -> None:
    refuse_table_settings(Path("shot.trz"), Config().replace(tab="a"))
    refuse_table_settings(
        Path("shot.mp4"), Config().replace(tab="a", length_unit="cm", camera=Path("shot.trk"))
    )


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ({"radius": -1.0}, "radius: -1.0 is not a radius in metres, 0.001 to 1"),
        ({"radius": float("nan")}, "radius: nan is not a radius in metres"),
        ({"restitution": 3.0}, "restitution: 3.0 is not a number from 0 to 1"),
        ({"friction": 0.5}, "friction: 0.5 is not a friction of ice"),
        ({"samples": -4}, "samples: -4 is not a number of samples, 0 to 100000"),
        ({"masses": {"A": 0.0}}, "mass of A: 0.0 is not a positive number"),
        ({"fps": float("inf")}, "fps: inf is not a positive number"),
        ({"stick": (1.0, 2.0, 1.0, 2.0, 0.5)}, "has no length"),
        ({"camera_height": 0.5}, "camera_height: 0.5 is not a height in metres, 1 to 100"),
        (
            {"camera_height": 5.0, "camera": "c.csv"},
            "`camera_height` belongs to a camera found by its",
        ),
        ({"length_unit": "furlong"}, "length_unit 'furlong': one of m, cm"),
        ({"angle_unit": "turn"}, "angle_unit 'turn': one of rad, deg"),
        ({"units": "yd"}, "units 'yd': one of m, ft"),
        ({"samples": 2.5}, "samples: 2.5 is not a number of samples"),
        ({"radius": "0.1"}, "radius: '0.1' is not a radius"),
        ({"fps": "25"}, "fps: '25' is not a positive number"),
        ({"fps": True}, "fps: True is not a positive number"),
        ({"length_unit": ["m"]}, r"length_unit \['m'\]: one of m, cm"),
        ({"samples": None}, "samples: None is not a number of samples"),
        ({"camera": 5}, "camera: 5 is not a path"),
        ({"angles": {"A": 5}}, "angles of A: 5 is not a path"),
        ({"names": {"A": 5}}, "track of A: 5 is not a text"),
        ({"tab": 1}, "tab: 1 is not a text"),
        ({"no_house": "yes"}, "no_house: 'yes' is not true or false"),
        ({"masses": [1, 2]}, "masses: a value for each stone, please"),
        ({"names": ["A"]}, "names: a value for each stone, please"),
        ({"stick": (1.0, 2.0, 3.0, 4.0)}, r"stick \[1.0, 2.0, 3.0, 4.0\]: 5 numbers, please"),
        ({"stick": "1,2,3"}, "stick '1,2,3': 5 numbers, please"),
        ({"house": (1, 2, 3)}, r"house \[1, 2, 3\]: 6 or 7 numbers, please"),
        ({"frames": ()}, r"frames \[\]: 1 or 2 numbers, please"),
        ({"frames": (0.5, 30)}, "frames: 0.5 is not a number of a frame"),
        ({"frames": (0, "end")}, "frames: 'end' is not a number of a frame"),
        ({"house": (0, 1, 2, 3, 4, 5, float("nan"))}, "house: nan is not a number"),
    ],
)
def test_what_the_command_refuses_is_refused_from_python(said: dict[str, Any], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        Config().replace(**said)


def test_paths_may_be_strings() -> None:
    settings = Config().replace(camera="camera.csv", angles={"A": "a.txt"})
    assert (settings.camera.camera, settings.tables.angles) == (
        Path("camera.csv"),
        {"A": Path("a.txt")},
    )


def test_a_frame_may_be_left_out_from_python_too() -> None:
    settings = Config().replace(house=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0), frames=(3,))
    assert settings.camera.house == (None, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert settings.video.frames == (3, None)


def test_only_changed_settings_are_live_in_the_file() -> None:
    config = Config().replace(min_evidence=1.2, samples=9).replace(samples=0)
    lines = config.to_toml().splitlines()
    live = [line for line in lines if line and line[0] not in "#["]
    assert [line.partition(" #")[0].rstrip() for line in live] == ["min_evidence = 1.2"]
    assert Config.from_text(config.to_toml()) == config
    assert Config().to_toml().count("\n# ") == len(config.values())
    assert {line.index(" # ", 2) for line in Config().to_toml().splitlines() if " # " in line} == {
        32
    }


def test_every_setting_stands_in_the_file_with_its_meaning_and_is_read_back() -> None:
    config = Config().replace(
        masses={"A b": 19.0}, names={"A": "mass A"}, frames=(3, None), min_evidence=1.2,
        house=(None, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0), overlay=False, units="ft",
    )  # fmt: skip
    text = config.to_toml()
    assert Config.from_text(text) == config
    for _, item in Config.settings():
        assert f"{item.name} =" in text
        assert item.metadata["meaning"] in text


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[vidoe]\nfps = 1.0", r"club.toml: no section \[vidoe\]; did you mean 'video'\?"),
        ("[video]\nfsp = 1.0", r"no key 'fsp' in \[video\]; did you mean 'fps'\?"),
        ("[video]\nfps = -1.0", "fps: -1.0 is not a positive number"),
        ("[video]\nfps = 'x'", "fps: 'x' is not a positive number"),
        ("video = 3", "video is a section"),
        ("[video", "club.toml: "),
        ("[camera]\nstick = [1, 2, 3]", "stick \\[1, 2, 3\\]: 5 numbers, please"),
        ("[stones]\nmasses = 19.0", "masses: a value for each stone, please, by its name"),
    ],
)
def test_a_file_with_a_mistake_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, reason: str
) -> None:
    path = tmp_path / "club.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=reason):
        Config.from_file(path)
    assert main(["config", "--config", str(path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_paths_in_a_file_are_relative_to_it_and_the_command_line_wins(tmp_path: Path) -> None:
    path = tmp_path / "club.toml"
    path.write_text("[camera]\ncamera = 'camera.csv'\n[stones]\nradius = 0.14\n", "utf-8")
    assert Config.from_file(path).camera.camera == tmp_path / "camera.csv"
    parsed = command_line("1").parse_args(["run", "--config", str(path), "--radius", "0.145"])
    assert config_of(parsed).stones.radius == 0.145


@pytest.mark.parametrize(
    ("line", "word", "name", "value"),
    [
        ("[video]\nclip = true", "--no-clip", "clip", False),
        ("[tables]\nno_house = true", "--tee", "no_house", False),
        ("[report]\noverlay = false", "--overlay", "overlay", True),
    ],
)
def test_the_command_line_reverses_a_file(
    tmp_path: Path, line: str, word: str, name: str, value: bool
) -> None:
    path = tmp_path / "club.toml"
    path.write_text(line, encoding="utf-8")
    words = ["run", "a.mp4", "--config", str(path)]
    assert config_of(command_line("1").parse_args(words)).values()[name] is not value
    assert config_of(command_line("1").parse_args([*words, word])).values()[name] is value


def test_an_unknown_setting_in_python_names_the_nearest() -> None:
    with pytest.raises(TypeError, match="no setting 'raduis'; did you mean 'radius'"):
        pipeline.run([], raduis=0.1)


def test_options_that_messages_name_are_settings_or_arguments_of_a_command() -> None:
    arguments = {"aim_offset", "config", "out", "over", "speed", "spin", "throw_sd"}
    assert arguments | {item.name for _, item in Config.settings()} >= OPTIONS
