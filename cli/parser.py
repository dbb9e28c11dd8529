"""Commands and options, with help and examples."""

from __future__ import annotations

import argparse
import re
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

from curlshot.cli import values
from curlshot.cli.options import (
    assumption_options,
    clip_options,
    config_option,
    mass_option,
    no_house_option,
    radius_option,
    rate_option,
    tab_option,
    table_options,
    units_option,
    what_if_options,
)
from curlshot.data.limits import JOBS


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, exit code 2."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        # Values may begin with a minus; of itself argparse knows numbers alone, not -1x or -5:9.
        self._negative_number_matcher = re.compile(r"^-\.?\d")

    def parse_known_args(self, *arguments: Any, **options: Any) -> tuple[Any, list[str]]:
        # A command would leave what it does not know to the whole line, whose help tells less.
        known, rest = super().parse_known_args(*arguments, **options)
        if rest:
            near = get_close_matches(rest[0].partition("=")[0], self._option_string_actions, 1)
            hint = f", did you mean {near[0]}?" if near else ""
            self.error(f"unrecognized arguments: {' '.join(rest)}{hint}")
        return known, rest

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def command_line(version: str) -> argparse.ArgumentParser:
    """Build the parser of the whole command line; ``command`` in its answer names the work."""
    parser = _Parser(
        prog="curlshot",
        description=(
            "From a clip of a curling shot to its physics: tracks, restitution, friction, and a"
            " simulation of the shot."
        ),
        epilog="examples:\n"
        "  curlshot run                               the bundled sample clip\n"
        "  curlshot run shot.mp4 -o shot              a clip, into the folder shot\n"
        "  curlshot run A.txt B.txt C.txt             tracks exported from Tracker\n"
        "  curlshot simulate SHOT.toml                a shot of your own\n"
        "  curlshot simulate shot/results.json --speed 1.1x\n"
        "                                             what if it had been faster?\n",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"curlshot {version}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    for add in (_run, _track, _check, _estimate, _season, _convert, _simulate, _config):
        add(commands)
    return parser


def _run(commands: Any) -> None:
    parser = _command(
        commands,
        "run",
        "the whole pipeline: clip or tracks to e, μ, simulation and report",
        "  curlshot run                                     the bundled sample\n"
        "  curlshot run shot.mp4                            a clip that shows the house\n"
        "  curlshot run frames/ --fps 25                    a folder of pictures\n"
        "  curlshot run 'frames/*.png' --fps 25             or a glob\n"
        "  curlshot run season/*.mp4 -o season              many clips, a folder for each, and\n"
        "                                                   e and μ of all of them together\n"
        "  curlshot run still.jpg                           one picture: positions only\n"
        "  curlshot run pucks.mp4 --stick 20,36,20,220,0.5 --radius 0.0465\n"
        "                                                   no house: still camera, known length\n"
        "  curlshot run shot.mp4 --house 12:640,360,460,360,640,180\n"
        "                                                   the tee, two points of the 12-ft ring\n"
        "  curlshot run shot.mp4 --camera camera.csv        a known camera, still or per frame\n"
        "  curlshot run A.txt B.txt --length-unit cm        one Tracker export per stone\n"
        "  curlshot run shot.trk                            what is marked in a Tracker project\n"
        "  curlshot run shot.trz --clip                     what the clip in it shows\n"
        "  curlshot run shot.trz --clip --camera shot.trz   the same, by its own calibration\n"
        "  curlshot run old/tracks.csv                      earlier tracks\n",
    )
    parser.add_argument("inputs", nargs="*", metavar="INPUT", help="clip, pictures or tables")
    clip_options(parser, "frame rate of pictures (25), or of a table without times, 1/s")
    mass_option(parser)
    table_options(parser)
    no_house_option(parser)
    tab_option(parser)
    config_option(parser)
    parser.add_argument(
        "--clip",
        action=argparse.BooleanOptionalAction,
        help="whether to measure the clip of a Tracker project, not the marks in it (the marks)",
    )
    assumption_options(parser)
    units_option(parser)
    parser.add_argument(
        "--overlay",
        action=argparse.BooleanOptionalAction,
        help="whether to write the annotated clip overlay.mp4 (it is written)",
    )
    parser.add_argument(
        "--jobs",
        type=values.whole(JOBS),
        metavar="N",
        help="number of clips to run at once (as many as there are processors)",
    )


def _track(commands: Any) -> None:
    parser = _command(
        commands,
        "track",
        "clip to tracks.csv and camera.csv only",
        "  curlshot track shot.mp4 -o shot\n"
        "  curlshot track shot.mp4 --camera earlier/camera.csv\n",
    )
    parser.add_argument("inputs", nargs="+", metavar="CLIP", help="a video or pictures")
    clip_options(parser)
    tab_option(parser)
    config_option(parser)


def _check(commands: Any) -> None:
    parser = _command(
        commands,
        "check",
        "a contact sheet to verify the camera and the stones found in this clip",
        "  curlshot check shot.mp4                  shot-curlshot/check.png\n"
        "  curlshot check shot.mp4 --house 640,360,460,360,640,180\n",
    )
    parser.add_argument("inputs", nargs="+", metavar="CLIP", help="a video or pictures")
    clip_options(parser)
    tab_option(parser)
    config_option(parser)


def _estimate(commands: Any) -> None:
    parser = _command(
        commands,
        "estimate",
        "tracks to results.json",
        "  curlshot estimate shot/tracks.csv\n"
        "  curlshot estimate pucks.csv --length-unit cm --radius 0.035 --mass A=32 --mass B=30\n",
    )
    parser.add_argument("inputs", nargs="+", metavar="TRACKS", help="tables of tracks")
    radius_option(parser)
    mass_option(parser)
    table_options(parser)
    no_house_option(parser)
    tab_option(parser)
    config_option(parser)
    assumption_options(parser)
    units_option(parser)
    rate_option(parser, "rate of a table without times, 1/s")


def _season(commands: Any) -> None:
    parser = _command(
        commands,
        "season",
        "e and μ of many shots together, from the folders of their runs",
        "  curlshot season shot1-curlshot shot2-curlshot -o both\n"
        "  curlshot season runs                             every run in this folder\n"
        "\n"
        "Shots differ by more than their errors: the mean comes with their scatter. Gives\n"
        "season.html (a page that leads to each shot), season.json, season.png, shots.csv and"
        " hits.csv.\n",
        usual="season",
    )
    parser.add_argument("runs", nargs="+", metavar="RUN", help="folder of a run, or of runs")


def _convert(commands: Any) -> None:
    parser = _bare_command(
        commands,
        "convert",
        "convert tracks; the ending of OUT gives the format",
        "  curlshot convert shot.trk shot.csv               a Tracker project to a table\n"
        "  curlshot convert shot-curlshot/tracks.csv a.txt  text for Tracker's import\n"
        "  curlshot convert A.txt B.txt shot.parquet        needs pyarrow\n"
        "  curlshot convert shot-curlshot/tracks.csv shot.trk --over shot.mp4\n"
        "                                                   a Tracker project over the clip\n"
        "  curlshot convert shot-curlshot/tracks.csv shot.trz --over shot.mp4\n"
        "                                                   the same, with the clip in the file\n"
        "  curlshot convert season/*.trk .csv               each to a table in its folder\n"
        "  curlshot convert season/*.trz tables/.csv        or in another folder\n",
    )
    parser.add_argument("inputs", nargs="+", metavar="IN", help="tables of tracks, projects")
    parser.add_argument(
        "out",
        metavar="OUT",
        help="a name that ends with .txt, .csv, .parquet, .trk or .trz; or only the ending, for a"
        " file of its own for each IN",
    )
    parser.add_argument("--over", metavar="CLIP", help="the clip of the project")
    table_options(parser)
    tab_option(parser)
    config_option(parser)
    rate_option(parser, "rate of a table without times, 1/s")


def _simulate(commands: Any) -> None:
    parser = _command(
        commands,
        "simulate",
        "simulate a shot of your own, or a measured one with changes, and where it ends",
        "  curlshot simulate SHOT.toml\n"
        "  curlshot simulate SHOT.toml --json --fps 50\n"
        "  curlshot simulate SHOT.toml --samples 2000           thrown 2000 times as players do\n"
        "  curlshot simulate shot-curlshot                      a measured shot, thrown again\n"
        "  curlshot simulate shot/results.json --aim-offset 0.05 --speed 1.1x -o wider\n"
        "                                                       what if: 5 cm to the left, faster\n"
        "  curlshot simulate shot/results.json --restitution 0.9 --friction 0.012 --spin -1.5\n"
        "\n"
        "A measured shot (the folder of a run, or its results.json) begins as it did in the clip,\n"
        "and is written into NAME-whatif. Samples are drawn from what it may have been\n"
        "(ensemble.json) and from what players are off by. They give outcomes.csv (where each\n"
        "stone ends in each sample), whatif.json and spread.png, a plan view.\n\n"
        "Any shot gives simulation.csv (its stones in time) and plan.png, from above.\n"
        "\n"
        "SHOT.toml, all of [physics] optional, and of a stone all but name, x and y:\n"
        "  [physics]\n"
        '  model = "frictional"       # point-mass | rigid-body | frictional\n'
        "  restitution = 1.0\n"
        "  stone_friction = 0.2       # of frictional, as inertia = 0.5, I / (m R^2)\n"
        '  ice = "fcv1"               # fcv1 or fit with a, v_c, b: friction a / (v + v_c) + b;\n'
        "                             # constant or penner with friction; fcv1 with gravity\n"
        '  curl = "fcv1"              # none | fcv1 with turn, loss, slow\n'
        "  radius = 0.145\n"
        '  sheet = "none"             # none | up | down: where stones that leave it go away\n'
        "  [[stone]]                  # one for each stone; SI, radians\n"
        '  name = "A"\n'
        "  x = 0.0\n"
        "  y = 0.0\n"
        "  vx = 0.0\n"
        "  vy = 2.4\n"
        "  omega = 1.5708\n"
        "  theta = 0.0\n"
        "  mass = 19.1\n"
        "  omega_after = [1.2, 1.0]   # after each of its hits: rigid-body needs it\n",
        usual="NAME-curlshot; of a measured shot NAME-whatif",
    )
    parser.add_argument(
        "shot",
        metavar="SHOT",
        type=Path,
        help="SHOT.toml, or the folder of a run, or its results.json",
    )
    rate_option(parser, "samples per second (25)", 25.0)
    parser.add_argument("--json", action="store_true", help="print the outcome as JSON")
    what_if_options(parser)


def _config(commands: Any) -> None:
    parser = _bare_command(
        commands,
        "config",
        "all settings with their units and meanings, as a file for --config",
        "  curlshot config > club.toml                      to be edited and used with\n"
        "  curlshot run shot.mp4 --config club.toml\n"
        "  curlshot config --config club.toml               what a file sets, checked\n",
    )
    config_option(parser)


def _command(
    commands: Any, name: str, summary: str, examples: str, usual: str = "NAME-curlshot"
) -> argparse.ArgumentParser:
    """Add a command that writes a folder, which has a `usual` name."""
    parser = _bare_command(commands, name, summary, examples)
    parser.add_argument(
        "-o", "--out", type=values.folder, metavar="OUT", help=f"folder for the files ({usual})"
    )
    return parser


def _bare_command(commands: Any, name: str, summary: str, examples: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=summary,
        description=(summary[0].upper() + summary[1:] + ".").replace("?.", "?"),
        epilog=f"examples:\n{examples}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="no progress bars")
    return parser
