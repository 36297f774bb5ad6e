"""Cameras from control points: what is found, what is refused, what is told of the quality; OpenCV beside it."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit_cameras import calibrate, make_laboratory, triangulate
from crashkit_cameras.dlt import cameras_of, coefficients_of, fit_linear, solve_points
from crashkit_cameras.projection import project

POINTS = np.random.default_rng(3).uniform(-1.0, 1.0, (1, 60, 3))


def test_eleven_coefficients_are_exact_without_distortion_and_make_the_camera() -> None:
    lab = make_laboratory(2, 10, seed=1)
    straight = evolve(lab.cameras, distortion=np.zeros((2, 5)))
    image = project(straight, lab.control)
    found = np.array([fit_linear(lab.control, one).coefficients for one in image])
    np.testing.assert_allclose(found, coefficients_of(straight)[:, :11], rtol=1e-7, atol=1e-9)
    camera = cameras_of(found, np.zeros(3))
    np.testing.assert_allclose(camera.position, lab.cameras.position, rtol=1e-7)
    np.testing.assert_allclose(camera.focal, lab.cameras.focal, rtol=1e-7)
    np.testing.assert_allclose(solve_points(found, image), lab.control, atol=1e-9)


def test_projection_agrees_with_opencv() -> None:
    cv2 = pytest.importorskip("cv2")
    camera = make_laboratory(1, 8, seed=2).cameras
    inner = np.array(
        [[camera.focal[0], 0.0, camera.centre[0, 0]], [0.0, camera.focal[0], camera.centre[0, 1]], [0.0, 0.0, 1.0]]
    )
    k1, k2, k3, p1, p2 = camera.distortion[0]
    turn, shift = cv2.Rodrigues(camera.rotation[0])[0], -camera.rotation[0] @ camera.position[0]
    theirs = cv2.projectPoints(POINTS[0], turn, shift, inner, np.array([k1, k2, p1, p2, k3]))[0][:, 0]
    np.testing.assert_allclose(project(camera, POINTS[0])[0], theirs, atol=1e-6)


def test_many_exact_points_give_the_true_cameras() -> None:
    lab = make_laboratory(2, 60, seed=4)
    found = calibrate(lab.record_points(POINTS, np.zeros(1)))
    np.testing.assert_allclose(found.cameras.position, lab.cameras.position, atol=1e-3)
    np.testing.assert_allclose(found.cameras.distortion[:, 0], lab.cameras.distortion[:, 0], rtol=0.02)
    assert found.from_readings[:, 0].min() > 0.9
    assert found.notes == ()


def test_a_blunder_is_named_and_does_no_harm() -> None:
    lab, random = make_laboratory(2, 20, seed=5), np.random.default_rng(1)
    group = lab.record_points(POINTS, np.zeros(1), random)
    clean = calibrate(group)
    group["control_image"][7, 0, 0] += 25.0
    found = calibrate(group)
    assert np.argwhere(found.rejected).tolist() == [[0, 7]]
    assert any("control point control_8 is off by 2" in note for note in found.notes)
    assert np.abs(found.cameras.position - clean.cameras.position).max() < 0.03


@pytest.mark.parametrize(
    ("squash", "count", "reason"),
    [
        ([1.0, 1.0, 1.0], 5, "found 5"),
        ([1.0, 1.0, 1e-3], 12, "found 12 within .* mm of a plane"),
        ([1.0, 1e-3, 1e-3], 12, "found 12 within .* mm of a line"),
    ],
)
def test_points_that_cannot_calibrate_are_refused_with_the_reason(squash: list[float], count: int, reason: str) -> None:
    lab = make_laboratory(2, count, seed=1)
    group = evolve(lab, control=lab.control * squash).record_points(POINTS, np.zeros(1))
    with pytest.raises(CrashkitError, match=f'view "camera_1": expected at least 6 control points, well spread .*, {reason}'):
        calibrate(group)


@pytest.mark.parametrize("k1", [-0.35, 0.25])
def test_lenses_unlike_others_are_found_too(k1: float) -> None:
    """The prior about lenses gives way to twenty readings, and the points are better than those of eleven coefficients."""
    lab, random = make_laboratory(2, 20, seed=6), np.random.default_rng(2)
    lens = lab.cameras.distortion * 0.0
    lens[:, 0] = k1
    lab = evolve(lab, cameras=evolve(lab.cameras, distortion=lens))
    group = lab.record_points(POINTS, np.zeros(1), random)
    np.testing.assert_allclose(calibrate(group).cameras.distortion[:, 0], k1, atol=0.05)
    control = group["control_image"].transpose("view", "control_point", "image_axis").values
    linear = np.array([fit_linear(lab.control, one).coefficients for one in control])
    by_eleven = solve_points(linear, group["image_position"].values[0]) - POINTS[0]
    ours = triangulate(group)["position"].values[0] - POINTS[0]
    assert np.sqrt(np.mean(ours**2)) < 0.7 * np.sqrt(np.mean(by_eleven**2))
