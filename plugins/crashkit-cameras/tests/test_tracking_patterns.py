"""The images that are fitted against direct integration, and the rendered ones against areas and centroids."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import erf

from crashkit_cameras.tracking import Imaging, Painted, Pose, render, true_position
from crashkit_cameras.tracking.dot import Dot
from crashkit_cameras.tracking.edge import edge
from crashkit_cameras.tracking.pattern import Pattern
from crashkit_cameras.tracking.quadrant import Quadrant

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
U, V = (grid.ravel().astype(float) for grid in np.meshgrid(np.arange(31), np.arange(31)))


def over_pixel(function: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> float:
    """The mean of a function of u and v over the unit square about the origin."""
    return float(0.25 * WEIGHTS @ function(0.5 * NODES[:, None], 0.5 * NODES) @ WEIGHTS)


@given(st.floats(-3, 3), st.floats(0.1, 2.0), st.floats(-np.pi, np.pi))
@settings(deadline=None, max_examples=60)
def test_an_edge_is_the_mean_over_the_pixels_square(distance: float, blur: float, angle: float) -> None:
    cos, sin = np.cos(angle), np.sin(angle)
    value, _, _ = edge(np.array(distance), np.array(blur**2), np.array(cos), np.array(sin))
    expected = over_pixel(lambda u, v: erf((distance + cos * u + sin * v) / (blur * np.sqrt(2))))
    assert value == pytest.approx(expected, abs=2e-4)


def test_an_edge_along_the_pixels_is_no_special_case() -> None:
    distance = np.linspace(-1, 1, 21)
    aligned, _, _ = edge(distance, np.array(1e-4), np.array(1.0), np.array(0.0))
    np.testing.assert_allclose(aligned, np.clip(2 * distance, -1, 1), atol=0.02)


def test_a_quadrant_is_the_product_of_two_signs_spread_by_blur_and_pixel() -> None:
    """Lines that are not at right angles: near their crossing the blurs are correlated."""
    angles, blur = np.array([0.3, 1.5]), 0.8
    shape = np.array([15.2, 14.9, *angles, blur**2, blur**2, np.cos(angles[1] - angles[0]), 10.0, 10.0])
    value, _ = Quadrant().values(shape, U, V)
    spread = np.random.default_rng(0).normal(0, blur, (2, 4000)) + np.random.default_rng(1).uniform(-0.5, 0.5, (2, 4000))
    at = np.stack([U - 15.2, V - 14.9])[:, :, None] + spread[:, None]
    signs = [np.sign(np.cos(angle) * at[0] + np.sin(angle) * at[1]) for angle in angles]
    near = np.hypot(U - 15.2, V - 14.9) < 8
    np.testing.assert_allclose(value[near], (signs[0] * signs[1]).mean(axis=1)[near], atol=0.06)


@pytest.mark.parametrize("pattern", [Quadrant(), Dot()], ids=lambda pattern: pattern.name)
def test_derivatives_agree_with_differences(pattern: Pattern) -> None:
    shape = pattern.shape(np.array([15.3, 14.8]), 8.0, 0.4)
    _, slopes = pattern.values(shape, U, V)
    size = np.max(np.abs(shape)) * 1e-5
    for number in range(2 if pattern.name == "dot" else pattern.fitted):  # of a dot's outline only to first order
        step = np.zeros_like(shape)
        step[number] = size
        difference = (pattern.values(shape + step, U, V)[0] - pattern.values(shape - step, U, V)[0]) / (2 * size)
        assert np.max(np.abs(slopes[number] - difference)) < 0.1 * np.max(np.abs(difference)), number


@pytest.mark.parametrize("imaging", [{}, {"defocus": 2.0}, {"exposure": 1.0}], ids=["sharp", "defocused", "moving"])
@pytest.mark.parametrize("angle", [0.0, 0.5, np.pi / 4])
def test_a_rendered_dot_has_the_area_and_the_centroid_of_a_disc(imaging: dict[str, float], angle: float) -> None:
    dot = Painted("dot", "dot", lambda time: Pose((25.31 + 3 * time, 24.78 + time), 7.0, angle), dark=0.0, bright=1.0)
    frame, blank = render([dot], Imaging(51, 51, ground=1.0, levels=60000, **imaging), [0.0, 50.0])
    darkness = (blank.image - frame.image.astype(float)) / 60000
    v, u = np.indices(darkness.shape)
    area = darkness.sum()
    assert area == pytest.approx(np.pi * 49, rel=2e-3)
    np.testing.assert_allclose([(u * darkness).sum() / area, (v * darkness).sum() / area], [25.31, 24.78], atol=3e-3)


def test_a_tilted_dot_is_an_ellipse_and_perspective_shifts_its_middle() -> None:
    """A disc of radius r at distance d (in radii), tilted by τ: the ellipse's centre lies r sin τ / d beside the disc's."""
    pose = Pose((40.0, 40.0), 12.0, tilt=0.7, distance=30.0)
    (frame,) = render([Painted("dot", "dot", lambda time: pose, 0.0, 1.0)], Imaging(81, 81, ground=1.0, levels=60000), [0.0])
    darkness = 1.0 - frame.image / 60000
    v, u = np.indices(darkness.shape)
    centre = np.array([(u * darkness).sum(), (v * darkness).sum()]) / darkness.sum()
    assert darkness.sum() == pytest.approx(np.pi * 144 * np.cos(0.7), rel=0.02)
    assert np.hypot(*(centre - 40.0)) == pytest.approx(12.0 * np.sin(0.7) * np.cos(0.7) / 30.0, rel=0.1)


def test_the_middle_of_a_pose_does_not_depend_on_perspective() -> None:
    homography = Pose((12.5, 30.25), 9.0, 0.3, 0.8, 0.4, 5.0).homography
    np.testing.assert_allclose(homography[:2, 2] / homography[2, 2], [12.5, 30.25])
    position = true_position([Painted("a", "quadrant", lambda time: Pose((time, 2.0), 5.0))], [1.0, 3.0])
    assert position.sel(time=3.0, marker="a").values.tolist() == [3.0, 2.0]


def test_what_is_painted_later_is_in_front_and_light_falls_on_everything() -> None:
    back = Painted("back", "card", lambda time: Pose((20.0, 20.0), 10.0), dark=0.2)
    front = Painted("front", "card", lambda time: Pose((20.0, 20.0), 5.0), dark=0.6)
    (frame,) = render([back, front], Imaging(41, 41, ground=1.0, levels=1000, light=(-0.01, 0.0)), [0.0])
    assert float(frame.image[20, 20]) == pytest.approx(600, rel=0.01)
    assert float(frame.image[20, 10]) == pytest.approx(220, rel=0.02)
    assert float(frame.image[2, 40]) == pytest.approx(805, rel=0.02)
    assert frame.image.dtype == np.uint16


def test_noise_is_that_of_the_seed() -> None:
    imaging = Imaging(40, 40, noise=5.0)
    first, again, other = (render([], imaging, [0.0], seed)[0].image for seed in (1, 1, 2))
    assert (first == again).all() and (first != other).any()
    assert np.std(first.astype(float)) == pytest.approx(5.0, rel=0.05)
