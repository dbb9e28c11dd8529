"""Clips on disk: times as the container tells them, cuts, cache, and the bundled sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from curlshot.synthetic import (
    Cut,
    Graphic,
    Person,
    describe,
    random_scene,
    sample_scene,
    still_camera,
    sweepers,
)


def test_people_graphics_and_cuts_hide_stones() -> None:
    scene = sample_scene()
    stone = next(s for s in scene.stones if s.name == "E").start
    camera = still_camera(target=(0, 0))
    over = Person(((0.0, stone.x, stone.y - 0.2, 1.57),))
    x, y = camera.at(0).project([stone.x, stone.y, 0.12])
    board = Graphic(x=int(x) - 30, y=int(y) - 30, row=40)
    for hiding in (
        replace(scene, people=(over,)),
        replace(scene, graphics=(board,)),
        replace(scene, cuts=(Cut(0.0, 1.0),)),
    ):
        truth = describe(hiding, camera, [0.5])
        visible = truth.tracks.set_index("stone")["visible"]
        assert visible["E"] < 0.3
    assert truth.camera["main"].tolist() == [0]


def test_sweepers_go_before_the_stone() -> None:
    scene = random_scene(np.random.default_rng(4), resting=1, speed=1.5)
    people = sweepers(scene, 1.4)
    assert len(people) == 2
    truth = describe(scene, still_camera(px_per_m=70), np.arange(0, 1.3, 0.1)).tracks
    stone = truth[truth["stone"] == "A"][["x", "y"]].to_numpy()
    for person in people:
        keys = np.array(person.path)
        t = np.arange(0, 1.3, 0.1)
        hips = np.column_stack([np.interp(t, keys[:, 0], keys[:, k]) for k in (1, 2)])
        far = np.hypot(*(hips - stone).T)
        assert far.min() > 0.9
        assert far.max() < 1.4
