from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from curlshot.tests.helpers.vision.reliefs import bar
from curlshot.tests.helpers.vision.reliefs import cap as picture_of
from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.detection.appearance import (
    BY_SHAPE,
    UNLIKE,
    Appearance,
    Colour,
    any_stone,
    colour_difference,
    colour_differences,
    learn,
    membership,
)
from curlshot.vision.detection.detection import Detection
from curlshot.vision.video.disk_cache import Cached

RED, YELLOW, BLUE, GREY = (30, 24, 150), (20, 190, 220), (170, 80, 30), (105, 105, 100)


def lab(bgr: tuple[int, int, int]) -> np.ndarray:
    pixel = np.array(bgr, np.uint8).reshape(1, 1, 3)
    return np.asarray(cv2.cvtColor(pixel, cv2.COLOR_BGR2LAB), float).ravel()


def seen(
    cap: tuple[int, int, int], score: float = 2.0, size: float = 1.0, wall: float = 0.0
) -> Detection:
    rng = np.random.default_rng(int(sum(cap)))
    return detection((0.0, 0.0), lab(cap), score)._replace(
        cap_samples=lab(cap) + rng.normal(0, 2, (60, 3)),
        granite_samples=lab(GREY) + rng.normal(0, 2, (60, 3)),
        outline=(size, 0.98),
        wall=wall,
    )


def worth_of(colours: list[tuple[int, int, int]], look: Appearance) -> list[float]:
    image = np.array(colours, np.uint8)[None]
    assert look.membership is not None
    return membership(image, look.membership)[0].tolist()


def test_caps_of_any_colour_are_worth_something_granite_the_contrary_and_ice_nothing() -> None:
    *caps, granite, ice, black = worth_of(
        [RED, YELLOW, BLUE, GREY, (225, 225, 220), (8, 8, 8)], any_stone(215)
    )
    assert min(caps) > 0.9
    assert granite < -0.9
    assert abs(ice) < 0.05 and abs(black) < 0.05


def test_a_dark_blue_cap_is_one_and_granite_that_red_paint_tinges_is_none() -> None:
    """Colours of stones in dim halls, where white ice has a lightness of 175."""
    dim = any_stone(175)
    assert min(worth_of([(87, 40, 22), (92, 46, 30), (77, 31, 17)], dim)) > 0.3
    assert max(worth_of([(45, 42, 66), (47, 45, 60)], dim)) < 0.1


def test_teal_and_dark_green_caps_are_some_and_neither_hair_nor_wood_nor_black_is() -> None:
    """Teals and dark greens are no farther from grey than hair: but there is no red in them."""
    look = any_stone(215)
    assert min(worth_of([(150, 140, 20), (74, 71, 12), (40, 70, 15), (33, 58, 12)], look)) > 0.3
    assert max(worth_of([(40, 60, 90), (110, 150, 190), (24, 22, 10)], look)) < 0.1


def test_a_light_blue_cap_is_one_and_granite_as_pale_of_another_hue_is_none() -> None:
    """A cap of chroma 30, as a clip without colour tags shows it."""
    look = any_stone(244)
    assert min(worth_of([(185, 144, 69), (190, 142, 64)], look)) > 0.3
    assert max(worth_of([(97, 107, 140), (112, 120, 150)], look)) < -0.3


def test_what_is_learned_tells_the_clip_s_caps_from_other_colours() -> None:
    look = learn([seen(RED)] * 9 + [seen(YELLOW)] * 6)
    assert look is not None and len(look.caps) == 2
    red, yellow, blue, granite = worth_of([RED, YELLOW, BLUE, GREY], look)
    assert red > 0.9 and yellow > 0.9
    assert granite < -0.9
    assert abs(blue) < 0.05


def test_of_more_than_two_colours_the_rarest_is_left_out_and_so_is_one_seen_by_chance() -> None:
    look = learn([seen(RED)] * 40 + [seen(YELLOW)] * 30 + [seen(BLUE, 3.0)] * 20)
    assert look is not None
    assert worth_of([BLUE], look)[0] < 0.05
    chance = learn([seen(RED)] * 40 + [seen(BLUE, 3.0)] * 2)
    assert chance is not None and len(chance.caps) == 1
    assert learn([]) is None


def test_of_more_than_two_colours_paint_is_left_out_that_shows_no_handle() -> None:
    flat, handled = (Cached(picture_of(bar(height), 1.0)) for height in (0.0, 30.0))
    stones = [seen(RED)._replace(spectrum=handled)] * 9 + [seen(YELLOW)._replace(spectrum=handled)]
    look = learn([*stones, *[seen(BLUE, 3.0)._replace(spectrum=flat)] * 2])
    assert look is not None
    assert worth_of([RED, YELLOW, BLUE], look) == pytest.approx([1, 1, 0], abs=0.1)
    two = learn([*stones[:9], *[seen(BLUE, 3.0)._replace(spectrum=flat)] * 2])
    assert two is not None and len(two.caps) == 2  # it may be a handle of the cap's own colour


@pytest.mark.parametrize(
    ("outline", "tint"),
    [
        ((1.08, 0.84), (-72, 18, -18)),
        ((1.0, 0.89), (-36, 28, 9)),
        ((1.0, 0.82), (0, 0, 0)),
        ((1.0, 0.98), (-72, 0, 0)),
        ((1.0, 0.98), (0, 26, -26)),
    ],
    ids=["on red", "on teal", "rim", "dark", "red"],
)
@pytest.mark.parametrize(("often", "score"), [(8, 1.9), (12, 1.6)])
def test_hair_on_jerseys_is_no_team_however_often_it_is_seen(
    outline: tuple[float, float], tint: tuple[int, int, int], often: int, score: float
) -> None:
    hair = seen((10, 8, 8), score)
    hair = hair._replace(granite_samples=hair.granite_samples + np.array(tint), outline=outline)
    look = learn([seen(BLUE)] * 9 + [hair] * often + [seen(RED)] * 5)
    assert look is not None and len(look.caps) == 2
    assert worth_of([RED, BLUE], look) == pytest.approx([1, 1], abs=0.1)
    assert look.outline == pytest.approx((1.0, 0.98))


@pytest.mark.parametrize(("rim", "teams"), [(0.86, 2), (0.81, 1)])
def test_where_no_granite_is_seen_the_rim_tells_a_team(rim: float, teams: int) -> None:
    other = seen(RED)
    other = other._replace(granite_samples=other.granite_samples[:0], outline=(1.0, rim))
    look = learn([seen(BLUE)] * 9 + [other] * 5)
    assert look is not None and len(look.caps) == teams


def test_a_team_whose_granite_differs_as_real_stones_do_is_kept() -> None:
    other = seen(RED)
    granite = other.granite_samples + np.array([17, 6, -12])
    hidden = other._replace(granite_samples=granite[:0])
    other = other._replace(granite_samples=granite, outline=(1.0, 1.01))
    for team in other, hidden:
        look = learn([seen(BLUE)] * 9 + [team] * 5)
        assert look is not None and len(look.caps) == 2


def test_a_team_whose_only_stone_in_view_lies_on_dark_paint_is_kept() -> None:
    other = seen(YELLOW, 2.35)
    granite = other.granite_samples + np.array([-8, -14, 3])
    other = other._replace(granite_samples=granite, outline=(1.0, 0.857))
    look = learn([seen(RED)] * 17 + [other] * 3)
    assert look is not None and len(look.caps) == 2


def test_the_size_of_caps_is_learned_from_three_detections_on() -> None:
    few, many = learn([seen(RED, size=1.04)] * 2), learn([seen(RED, size=1.04)] * 5)
    assert few is not None and many is not None
    assert few.outline[0] == 1.0
    assert many.outline == pytest.approx((1.04, 0.98))
    assert many.slack < few.slack


def test_the_wall_of_caps_is_learned_once_for_the_clip() -> None:
    look = learn([seen(RED, wall=height) for height in (0.004, 0.006, 0.009)])
    assert look is not None
    assert look.wall[0] == pytest.approx(0.006)
    assert look.wall[1] < any_stone().wall[1]


def test_greys_near_granite_are_told_place_by_place_in_recordings_without_colours() -> None:
    def own(cap: int, tinge: float = 0.0) -> bool:
        """Whether caps of a grey, with granite of a tinge, are to be told by their own colours."""
        one = seen((cap,) * 3)
        caps, granite = (
            values * [1, 0, 0] + [0, 128, 128] for values in (one.cap_samples, one.granite_samples)
        )
        tinged = granite + np.array([0, tinge, 0])
        look = learn([one._replace(cap_samples=caps, granite_samples=tinged)] * 5)
        assert look is not None
        return look.own

    assert own(90) and own(140)
    assert not own(25) and not own(240)
    assert own(90, tinge=2.0), "as coding may make it"
    assert not own(90, tinge=5.0), "this recording has colours"


def test_colours_differ_by_hue_more_than_by_light() -> None:
    bright, dim = np.array([140.0, 190.0, 160.0]), np.array([90.0, 190.0, 160.0])
    other = np.array([140.0, 150.0, 190.0])
    assert colour_difference(bright, dim) < UNLIKE < colour_difference(bright, other)
    table = colour_differences(np.array([bright, other]), np.array([dim]))
    assert table.shape == (2, 1)
    assert table[0, 0] == pytest.approx(colour_difference(bright, dim))


def test_caps_without_hue_differ_by_their_lightness() -> None:
    light, dull, dim = (np.array([level, 128.0, 128.0]) for level in (190.0, 120.0, 160.0))
    assert colour_difference(light, dim) < UNLIKE < colour_difference(light, dull)
    red = np.array([120.0, 190.0, 160.0])  # beside a hue, lightness counts as it does among hues
    assert colour_difference(dull, red) == pytest.approx(colour_difference(light, red), abs=4)


def test_the_nearest_cap_and_how_far_it_is() -> None:
    look = learn([seen(RED)] * 3 + [seen(YELLOW)] * 3)
    assert look is not None
    for rank, cap in enumerate(look.caps):
        away = cap.mean + np.array([0.0, 6.0, 8.0])
        assert look.nearest(away) == (rank, pytest.approx(10.0))
    assert look.nearest(lab(BLUE))[1] > UNLIKE


def test_stones_of_other_teams_differ_by_most_of_what_the_teams_do() -> None:
    spread = np.eye(3)
    red, orange = Colour(lab(RED), spread), Colour(lab(RED) + np.array([0, 0, 40]), spread)
    assert replace(BY_SHAPE, caps=(red, orange)).other_team == pytest.approx(30)
    assert replace(BY_SHAPE, caps=(red,)).other_team == BY_SHAPE.other_team == np.inf


def test_distances_of_colours_are_in_standard_deviations() -> None:
    colour = Colour(np.array([100.0, 150.0, 140.0]), np.diag([400.0, 25.0, 25.0]))
    away = colour.distance(
        (colour.mean + np.array([[20.0, 0, 0], [0, 10.0, 0]])).astype(np.float32)
    )
    np.testing.assert_allclose(away, [1, 2], rtol=1e-5)
