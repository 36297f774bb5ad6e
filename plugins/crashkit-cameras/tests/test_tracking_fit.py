"""How exactly targets are found in single images, and how well that is told."""

import numpy as np
import pytest

from crashkit_cameras.tracking import Imaging, Painted, Pose, render
from crashkit_cameras.tracking.fit import Fit, fit
from crashkit_cameras.tracking.patterns import pattern_of

KINDS = ["quadrant", "dot"]
SIZE, RADIUS = 49, 10.0


def pictured(kind: str, centre: np.ndarray, angle: float = 0.3, tilt: float = 0.0, **imaging: object) -> np.ndarray:
    """A target as a camera takes it; an exposure of 1 moves it by 3 pixels."""

    def pose(time: float) -> Pose:
        return Pose((centre[0] + 2.4 * time, centre[1] + 1.8 * time), RADIUS, angle, tilt, 0.6)

    return render([Painted("target", kind, pose)], Imaging(SIZE, SIZE, ground=0.4, **imaging), [0.0])[0].image  # type: ignore[arg-type]


def found(kind: str, image: np.ndarray, near: np.ndarray, angle: float = 0.3, tilt: float = 0.0) -> Fit:
    """The fit from a start that is not exact."""
    pattern = pattern_of(kind)
    result = fit(pattern, image, pattern.shape(near + [0.8, -0.6], 0.95 * RADIUS * np.sqrt(np.cos(tilt)), angle + 0.08))
    assert result is not None
    return result


def centres(count: int) -> np.ndarray:
    """Middles of the image, at every place within a pixel."""
    return 24.0 + np.random.default_rng(7).uniform(-0.5, 0.5, (count, 2))


CONDITIONS = {
    "clean": {},
    "sharp": {"defocus": 0.0},
    "noisy": {"noise": 4.0},
    "defocused": {"defocus": 2.0},
    "moving": {"exposure": 1.0, "noise": 1.0},
    "shaded": {"light": (0.01, -0.005), "noise": 1.0},
    "tone curve": {"gamma": 2.2},
    "tilted": {"tilt": 0.8, "noise": 1.0},
    "12 bits": {"levels": 4095, "noise": 30.0},
}


@pytest.mark.parametrize("condition", CONDITIONS)
@pytest.mark.parametrize("kind", KINDS)
def test_targets_are_found_to_two_hundredths_of_a_pixel(kind: str, condition: str) -> None:
    options = CONDITIONS[condition]
    tilt = float(options.get("tilt", 0.0))  # type: ignore[arg-type]
    errors = []
    for centre, angle in zip(centres(8), np.linspace(0.0, 1.5, 8), strict=True):
        image = pictured(kind, centre, angle, **options)  # type: ignore[arg-type]
        errors.append(found(kind, image, centre, angle, tilt).centre - centre)
    assert np.sqrt(np.mean(np.square(errors))) < 0.02
    assert np.median(np.hypot(*np.transpose(errors))) < 0.015


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("noise", [2.0, 6.0])
def test_the_stated_deviation_is_that_of_the_errors(kind: str, noise: float) -> None:
    random = np.random.default_rng(11)
    deviations = []
    for number, centre in enumerate(centres(4)):
        image = pictured(kind, centre, 0.2 + 0.3 * number, levels=255).astype(float)
        for _ in range(30):
            result = found(kind, image + noise * random.standard_normal(image.shape), centre, 0.2 + 0.3 * number)
            deviations.append((result.centre - centre) / result.std)
    inside = np.mean(np.abs(deviations) < 1.0), np.mean(np.abs(deviations) < 2.0)
    assert 0.85 < np.sqrt(np.mean(np.square(deviations))) < 1.2
    assert 0.61 < inside[0] < 0.78 and 0.92 < inside[1] < 0.99


@pytest.mark.parametrize("kind", KINDS)
def test_noise_that_depends_on_brightness_is_told_too(kind: str) -> None:
    """Shot noise: bright parts vary more."""
    random, centre = np.random.default_rng(3), np.array([24.2, 23.9])
    image = pictured(kind, centre).astype(float)
    results = [found(kind, image + np.sqrt(image / 6.0) * random.standard_normal(image.shape), centre) for _ in range(80)]
    deviations = [(one.centre - centre) / one.std for one in results]
    assert 0.8 < np.sqrt(np.mean(np.square(deviations))) < 1.2


@pytest.mark.parametrize("kind", KINDS)
def test_a_glint_is_left_out(kind: str) -> None:
    centre = np.array([24.3, 24.1])
    image = pictured(kind, centre, noise=1.0)
    clean = found(kind, image, centre)
    image[18:22, 20:23] = 255
    with_glint = found(kind, image, centre)
    assert np.hypot(*(with_glint.centre - centre)) < 0.03
    assert with_glint.quality < clean.quality


def test_a_quadrant_is_found_behind_an_obstacle_and_its_quality_tells() -> None:
    centre = np.array([24.3, 24.1])
    target = Painted("target", "quadrant", lambda time: Pose((24.3, 24.1), RADIUS, 0.3))
    card = Painted("in front", "card", lambda time: Pose((35.3, 24.0), 5.0), dark=0.3)
    (frame,) = render([target, card], Imaging(SIZE, SIZE, noise=1.0, ground=0.4), [0.0])
    result = found("quadrant", frame.image, centre)
    assert np.hypot(*(result.centre - centre)) < 0.03
    assert result.quality < 0.97


@pytest.mark.parametrize("kind", KINDS)
def test_saturated_pixels_do_not_pull(kind: str) -> None:
    """The light rises to the right until the card is as white as can be recorded."""
    errors = []
    for centre in centres(6):
        image = pictured(kind, centre, light=(0.02, 0.0), noise=1.0)
        assert (image == 255).mean() > 0.05
        errors.append(found(kind, image, centre).centre - centre)
    assert np.abs(np.mean(errors, axis=0)).max() < 0.01


@pytest.mark.parametrize("kind", KINDS)
def test_brightness_has_no_unit(kind: str) -> None:
    image = pictured(kind, np.array([24.3, 24.1]), noise=2.0)
    whole, scaled = (found(kind, one, np.array([24.3, 24.1])) for one in (image.astype(float), image / 1000.0 - 3.0))
    np.testing.assert_allclose(scaled.centre, whole.centre, atol=2e-3)
    np.testing.assert_allclose(scaled.std, whole.std, rtol=0.02)
    assert scaled.contrast == pytest.approx(whole.contrast / 1000.0, rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_where_there_is_no_target_none_is_found_or_its_quality_tells(kind: str) -> None:
    pattern, random = pattern_of(kind), np.random.default_rng(5)
    for _ in range(5):
        image = 100.0 + 5.0 * random.standard_normal((SIZE, SIZE)) + np.arange(SIZE)
        result = fit(pattern, image, pattern.shape(np.array([24.0, 24.0]), RADIUS, 0.0))
        assert result is None or result.quality < 0.4


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("centre", [(3.0, 24.0), (24.0, 46.0), (-30.0, 10.0), (24.0, 200.0)])
def test_a_target_that_is_not_whole_in_the_image_is_not_found(kind: str, centre: tuple[float, float]) -> None:
    image = pictured(kind, np.array(centre))
    pattern = pattern_of(kind)
    assert fit(pattern, image, pattern.shape(np.array(centre), RADIUS, 0.3)) is None
