"""Options that several commands share."""

from __future__ import annotations

import argparse
from pathlib import Path

from curlshot.cli import values
from curlshot.data.coach_units import UNITS
from curlshot.data.limits import (
    FRACTION,
    FRICTION,
    HEIGHT,
    MOST_THROWS,
    OFFSET,
    POSITIVE,
    RADIUS,
    SAMPLES,
)
from curlshot.data.sheet import STONE
from curlshot.data.units import ANGLE_UNITS, LENGTH_UNITS


def radius_option(parser: argparse.ArgumentParser) -> None:
    """Add the radius of the discs."""
    parser.add_argument(
        "--radius",
        type=values.within(RADIUS),
        metavar="METRES",
        help=f"radius of the discs ({STONE.radius}: a curling stone)",
    )


def config_option(parser: argparse.ArgumentParser) -> None:
    """Add the file of settings."""
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE.toml",
        help=(
            "settings of a rink or a camera; options of the command line override them (curlshot"
            " config prints all of them)"
        ),
    )


def mass_option(parser: argparse.ArgumentParser) -> None:
    """Add the masses of the discs, for commands that estimate e and μ."""
    parser.add_argument(
        "--mass",
        dest="masses",
        type=values.mass,
        action="append",
        metavar="STONE=MASS",
        help="mass of a disc, where they are not all equal (any unit)",
    )


def rate_option(parser: argparse.ArgumentParser, rate: str, usual: float | None = None) -> None:
    """Add a rate, of which `rate` says of what it is, and what it is if not given."""
    parser.add_argument("--fps", type=values.within(POSITIVE), default=usual, help=rate)


def clip_options(
    parser: argparse.ArgumentParser, rate: str = "frame rate of pictures, 1/s (25)"
) -> None:
    """Add what may be said of a clip; `rate` says of what that is."""
    radius_option(parser)
    rate_option(parser, rate)
    parser.add_argument(
        "--frames",
        type=values.frame_range,
        metavar="FIRST:LAST",
        help="frames to use, both included",
    )
    parser.add_argument(
        "--stick",
        type=values.stick,
        metavar="X1,Y1,X2,Y2,METRES",
        help="calibration stick for a still camera without a house: two pixels, their distance",
    )
    parser.add_argument(
        "--house",
        type=values.house,
        metavar="FRAME:XC,YC,X1,Y1,X2,Y2",
        help=(
            "where the house is, if it is not found automatically: the tee and two points on the"
            " outer edge of the 12-ft ring, px, in that frame (FRAME: may be left out: the first)"
        ),
    )
    parser.add_argument(
        "--camera",
        type=Path,
        metavar="CAMERA",
        help="a known camera, as a run's camera.csv: one row for a still camera, or one per frame;"
        " or a Tracker project, for its calibration",
    )
    parser.add_argument(
        "--camera-height",
        type=values.within(HEIGHT),
        metavar="METRES",
        help=(
            "height of the camera above the ice, to 0.1 m; needed where the view does not"
            " determine it, as from straight above"
        ),
    )


def what_if_options(parser: argparse.ArgumentParser) -> None:
    """Add what may be changed in a shot, and how often it is thrown."""
    change = parser.add_argument_group("what if")
    change.add_argument(
        "--restitution", type=values.within(FRACTION), metavar="E", help="e of the hits, 0 to 1"
    )
    change.add_argument(
        "--friction",
        type=values.within(FRICTION),
        metavar="MU",
        help="μ of the ice at 1 m/s, 0.001 to 0.1",
    )
    change.add_argument(
        "--aim-offset",
        type=values.within(OFFSET),
        default=0.0,
        metavar="METRES",
        help="shift the path of the thrown stone to its left, or right if negative, m",
    )
    change.add_argument(
        "--speed",
        type=values.speed,
        metavar="V",
        help="of the thrown stone: m/s, or a factor as 1.1x",
    )
    change.add_argument(
        "--spin",
        type=values.amount,
        metavar="W",
        help="of the thrown stone: rad/s, or a factor as 0.5x; -1x is the other way round",
    )
    change.add_argument(
        "--samples",
        type=values.whole(SAMPLES),
        metavar="N",
        help=f"throw it N times, at most {MOST_THROWS} (1000 for a measured shot, else 0)",
    )
    change.add_argument(
        "--throw-sd",
        type=values.throw_sd,
        metavar="V,A",
        help="standard deviations of the throw: m/s, rad (0.0076,0.0018)",
    )


def assumption_options(parser: argparse.ArgumentParser) -> None:
    """Add what predictions assume, and how much is drawn."""
    parser.add_argument(
        "--restitution",
        type=values.within(FRACTION),
        metavar="E",
        help="e that predictions assume (0.83 ± 0.06)",
    )
    parser.add_argument(
        "--friction",
        type=values.within(FRICTION),
        metavar="MU",
        help="μ that predictions assume (0.0109 ± 0.003, of discs that are no stones 0.01 ± 0.1)",
    )
    parser.add_argument(
        "--samples",
        type=values.whole(SAMPLES),
        metavar="N",
        help=(
            "draw e, μ and the friction between stones N times from their posterior:"
            " posterior.csv, quantiles in results.json"
        ),
    )


def units_option(parser: argparse.ArgumentParser) -> None:
    """Add the unit of what coaches read."""
    parser.add_argument(
        "--units",
        choices=tuple(UNITS),
        help="unit of the coach's tables (m); all else is SI",
    )


def tab_option(parser: argparse.ArgumentParser) -> None:
    """Add the tab of a project."""
    parser.add_argument("--tab", metavar="NAME", help="of a Tracker project with several tabs")


def no_house_option(parser: argparse.ArgumentParser) -> None:
    """Add whether tables count from a tee, for commands to which that matters."""
    parser.add_argument(
        "--no-house",
        action="store_true",
        default=None,
        help="the origin of tables is not the tee of a house",
    )
    parser.add_argument(
        "--tee",
        dest="no_house",
        action="store_false",
        default=None,
        help="the origin of tables is the tee of a house, whatever --config has (it is)",
    )


def table_options(parser: argparse.ArgumentParser) -> None:
    """Add what may be said of tables."""
    parser.add_argument(
        "--length-unit", choices=tuple(LENGTH_UNITS), help="of tables (as the file says, else m)"
    )
    parser.add_argument("--angle-unit", choices=tuple(ANGLE_UNITS), help="of tables")
    parser.add_argument(
        "--names",
        type=values.pair,
        action="append",
        metavar="STONE=TRACK",
        help='which tracks are stones, e.g. --names A="mass A" --names B="mass B" (all)',
    )
    parser.add_argument(
        "--angles",
        type=values.pair,
        action="append",
        metavar="STONE=FILE",
        help="angle of a stone: an export of a point of its edge about its centre",
    )
