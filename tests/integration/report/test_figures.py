from __future__ import annotations

import dataclasses

from curlshot.data.results import MeasuredState
from curlshot.report import figures
from curlshot.tests.helpers.report.drawn import check_layout, residuals


def test_long_and_strange_names_and_close_hits_fit(shot):
    new = {"A": "red stone $x_1$ <the first one>", "B": "масса Б", "C": "_c", "D": "石"}
    tracks = shot.tracks.replace({"stone": new})
    first = shot.results.collisions[0]

    def renamed(side: dict[str, MeasuredState]) -> dict[str, MeasuredState]:
        return {new[name]: state for name, state in side.items()}

    hits = [
        dataclasses.replace(
            first,
            t=0.8 + 0.06 * k,
            stones=(new["A"], new["B"]),
            before=renamed(first.before),
            after=renamed(first.after),
        )
        for k in range(6)
    ]
    simulations = {k: v.replace({"stone": new}) for k, v in shot.simulations.items()}
    for figure in (
        figures.plan_figure(tracks, simulations, hits, house=None),
        figures.speed_figure(tracks, hits),
        figures.motion_figure(tracks, new["A"], hits),
        figures.spin_figure(tracks, new["A"], hits),
        figures.residuals_figure(residuals(shot).replace({"stone": new}), hits),
        figures.friction_figure(
            [dataclasses.replace(g, stone=new[g.stone]) for g in shot.results.glides],
            shot.results.friction,
            tracks,
        ),
        figures.comparison_figure(tracks, simulations, new["B"], hits),
        figures.hit_figure(hits[0], 1),
    ):
        check_layout(figure)
