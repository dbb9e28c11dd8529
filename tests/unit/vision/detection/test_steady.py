import numpy as np
import pytest

from curlshot.tests.helpers.vision.tracks import detection
from curlshot.vision.detection.detection import Detection
from curlshot.vision.detection.steady import FEWEST, MEMORY, common_share, lightness_of, steadied

RATE = 25.0
LAMPS = np.array([0.0012, -0.0007])


def waves(rng: np.random.Generator, times: np.ndarray, size: float) -> np.ndarray:
    """What is alike for half a second or so, shape (n, 2), m."""
    kernel = np.exp(-0.5 * ((times[:, None] - times) / 0.2) ** 2)
    rough = kernel @ rng.normal(size=(len(times), 2))
    return np.asarray(size * rough / rough.std())


def seen_by(
    hue: np.ndarray, light: np.ndarray, way: np.ndarray, visible: float = 1.0
) -> list[Detection]:
    """Detections of a way by errors of the edges by hue and by lightness."""
    places = (way + hue).tolist()
    aside = (light - hue + LAMPS).tolist()
    return [
        detection((x, y))._replace(light=(u, v), visible=visible, sd_x=1e-3, sd_y=2e-3)
        for (x, y), (u, v) in zip(places, aside, strict=True)
    ]


def alone(times: list[float], seen: list[Detection]) -> list[Detection]:
    """A stone that no other has caps like, steadied."""
    light = lightness_of(times, seen)
    return steadied(seen, light, common_share([light]))


def errors(seen: list[Detection], way: np.ndarray) -> np.ndarray:
    return np.array([(s.x, s.y) for s in seen]) - way


@pytest.fixture(params=[0.0, 1.4], ids=["at rest", "gliding"])
def shot(request: pytest.FixtureRequest) -> tuple[np.ndarray, np.ndarray, np.random.Generator]:
    times = np.arange(200) / RATE
    way = np.column_stack([0.1 * times, 3 - request.param * times + 0.05 * times**2])
    return times, way, np.random.default_rng(4)


def test_lightness_steadies_what_hue_lets_wander_and_lamps_draw_nothing_aside(
    shot: tuple[np.ndarray, np.ndarray, np.random.Generator],
) -> None:
    times, way, rng = shot
    hue = waves(rng, times, 6e-4) + rng.normal(0, 5e-4, way.shape)
    light = rng.normal(0, 2e-4, way.shape)
    seen = seen_by(hue, light, way)
    before, after = errors(seen, way), errors(alone(times.tolist(), seen), way)
    assert after.std() < 0.5 * before.std()
    np.testing.assert_allclose(after.mean(0), before.mean(0), atol=1e-4)
    stated = np.array([(s.sd_x, s.sd_y) for s in alone(times.tolist(), seen)])
    np.testing.assert_allclose(stated[:, 1], 2 * stated[:, 0])
    assert 0.2e-3 < stated[0, 0] < 0.6e-3


def test_lightness_that_scatters_more_than_hue_has_no_say(
    shot: tuple[np.ndarray, np.ndarray, np.random.Generator],
) -> None:
    times, way, rng = shot
    seen = seen_by(rng.normal(0, 2e-4, way.shape), rng.normal(0, 1e-3, way.shape), way)
    before, after = errors(seen, way), errors(alone(times.tolist(), seen), way)
    assert after.std() <= before.std()
    assert np.abs(after - before).std() < 0.1 * 1e-3


def test_lightness_that_goes_astray_within_a_second_has_little_say() -> None:
    times = np.arange(300) / RATE
    way, rng = np.zeros((300, 2)), np.random.default_rng(8)
    turning = 2e-3 * np.column_stack([np.cos(5 * times), np.sin(5 * times)])
    hue, light = rng.normal(0, 4e-4, way.shape), turning + rng.normal(0, 1e-4, way.shape)
    seen = seen_by(hue, light, way)
    before, after = errors(seen, way), errors(alone(times.tolist(), seen), way)
    assert np.abs(after - before).max() < 0.5 * np.abs(turning).max()
    assert after.std() < before.std()


def test_a_track_too_short_to_show_that_lightness_goes_astray_stays() -> None:
    times = np.arange(30) / RATE
    way, rng = np.zeros((30, 2)), np.random.default_rng(8)
    turning = 2e-3 * np.column_stack([np.cos(5 * times), np.sin(5 * times)])
    seen = seen_by(rng.normal(0, 4e-4, way.shape), turning, way)
    assert alone(times.tolist(), seen) == seen


@pytest.mark.parametrize("dropped", [0.1, 0.5])
def test_a_glide_is_steadied_where_pictures_are_dropped_too(dropped: float) -> None:
    rng = np.random.default_rng(11)
    times = (np.arange(400) / RATE)[rng.random(400) > dropped]
    way = np.column_stack([0.1 * times, 3 - 1.4 * times + 0.04 * times**2])
    hue, light = rng.normal(0, 7e-4, way.shape), rng.normal(0, 2e-4, way.shape)
    after = alone(times.tolist(), seen_by(hue, light, way))
    left = errors(after, way).std() / hue.std()
    assert left < 0.5
    assert after[0].sd_x == pytest.approx(1e-3 * left, rel=0.25)


def test_lamps_may_draw_aside_to_another_side_after_a_while() -> None:
    times = np.arange(600) / RATE
    way = np.zeros((600, 2))
    drift = np.column_stack([2e-4 * times, 0 * times])
    rng = np.random.default_rng(2)
    seen = seen_by(rng.normal(0, 5e-4, way.shape), drift + rng.normal(0, 1e-4, way.shape), way)
    after = errors(alone(times.tolist(), seen), way)
    inner = after[(times > MEMORY) & (times < times[-1] - MEMORY)]
    assert np.abs(inner).max() < 6e-4


def test_what_is_half_covered_few_or_dark_all_over_stays() -> None:
    times = np.arange(60) / RATE
    way, rng = np.zeros((60, 2)), np.random.default_rng(3)
    hue, light = rng.normal(0, 1e-3, (2, 60, 2))
    covered = seen_by(hue, 0 * light, way, visible=0.6)
    assert alone(times.tolist(), covered) == covered
    seen = seen_by(hue, 0 * light, way)
    few = seen[: FEWEST - 1]
    assert alone(times[: len(few)].tolist(), few) == few
    blank = [s._replace(light=(np.nan, np.nan)) for s in seen]
    assert alone(times.tolist(), blank) == blank
    alike = [s._replace(light=(0.0, 0.0), x=0.0, y=0.0) for s in seen]
    assert alone(times.tolist(), alike) == alike


@pytest.mark.parametrize("seed", range(4))
def test_a_stone_that_is_struck_halfway_is_steadied_as_others_are(seed: int) -> None:
    # The hit is in three of five of its jerks over half a second.
    times, rng = np.arange(240) / 60.0, np.random.default_rng(seed)
    after_hit = np.maximum(times - 2.31, 0)
    way = np.column_stack([0.4 * after_hit, -0.9 * after_hit + 0.05 * after_hit**2])
    hue = waves(rng, times, 6e-4) + rng.normal(0, 3e-4, way.shape)
    light = rng.normal(0, 2e-4, way.shape)
    struck, other = (
        errors(alone(times.tolist(), seen_by(hue, light, own)), own) for own in (way, 0 * way)
    )
    assert struck.std() < 1.03 * other.std() < 0.63 * hue.std()


@pytest.mark.parametrize("seed", range(4))
def test_a_hit_in_each_jerk_of_a_stone_does_not_hide_what_others_tell(seed: int) -> None:
    rng, times = np.random.default_rng(seed), np.arange(65) / RATE
    ways = np.zeros((4, len(times), 2))
    ways[0] = [0.1, -1.4] * times[:, None] + [0.4, 0.9] * np.maximum(times - 1.3, 0)[:, None]
    stones = []
    for way in ways:
        hue = waves(rng, times, 6e-4) + rng.normal(0, 3e-4, way.shape)
        stones.append(seen_by(hue, rng.normal(0, 2e-4, way.shape), way))
    lights = [lightness_of(times.tolist(), seen) for seen in stones]
    assert common_share(lights) == pytest.approx(common_share(lights[1:]), abs=0.1)


def test_where_its_jerks_tell_nothing_the_errors_of_a_stone_stay() -> None:
    times, rng = np.arange(100) / RATE, np.random.default_rng(5)
    still = np.zeros((100, 2))
    seen = seen_by(rng.normal(0, 1e-3, still.shape), still, still)
    seen = [s._replace(light=(0.0, 0.0)) for s in seen]
    steady = steadied(seen, lightness_of(times.tolist(), seen), 0.7)
    assert [(s.sd_x, s.sd_y) for s in steady] == [(s.sd_x, s.sd_y) for s in seen]


def test_like_caps_tell_together_by_how_much_lightness_steadies() -> None:
    rng = np.random.default_rng(6)

    def drawn(count: int) -> tuple[list[float], list[Detection], np.ndarray]:
        times = np.arange(count) / RATE
        way = np.column_stack([0.1 * times, 3 - 1.4 * times + 0.05 * times**2])
        hue = waves(rng, times, 4e-4) + rng.normal(0, 3e-4, way.shape)
        light = waves(rng, times, 2.5e-4) + rng.normal(0, 2e-4, way.shape)
        return times.tolist(), seen_by(hue, light, way), way

    stones = [drawn(count) for count in (100, 100, 100, 100, 100, 100, 30)]
    lights = [lightness_of(times, seen) for times, seen, _ in stones]
    together = common_share(lights)
    # By the powers above, (4² + 3²) / (4² + 3² + 2.5² + 2²) of it.
    assert together == pytest.approx(0.71, abs=0.15)
    shares = [common_share([light]) for light in lights[:-1]]
    assert min(shares) < together < max(shares)

    # One that is too short to tell is steadied as the others say.
    _, seen, way = stones[-1]
    assert common_share([lights[-1]]) == 0
    before, after = errors(seen, way), errors(steadied(seen, lights[-1], together), way)
    assert after.std() < 0.85 * before.std()
    assert steadied(seen, lights[-1], together)[0].sd_x < seen[0].sd_x


def test_no_stone_at_all_has_no_share() -> None:
    assert common_share([]) == 0
