"""Where the iteration for a camera begins: the linear solution, and the ideal camera that is like it."""

from collections.abc import Sequence

import numpy as np
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit_cameras.bundle import Estimate, Readings, adjust
from crashkit_cameras.control import Control
from crashkit_cameras.dlt import SUBSET, LinearFit, cameras_of, fit_linear, fit_linear_robust
from crashkit_cameras.noise import USUAL, blunders, first_std
from crashkit_cameras.prior import Expectation, Frame, Prior, expectation
from crashkit_cameras.projection import PARAMETERS, Cameras, join

POSE_AND_FOCAL = 7
SUSPICIOUS = 1.0
"""pixel; noise from which blunders may hide among the readings."""


def start_cameras(control: Control, frame: Frame, prior: Prior) -> Cameras:
    """Each view's most probable camera if readings are as noisy as usual; blunders among them do not matter."""
    views = range(len(control.image))
    return join([_start(control.select(view), frame.select(view), prior) for view in views])


def _start(control: Control, frame: Frame, prior: Prior) -> Cameras:
    points, image = control.points[control.seen[0]], control.image[0, control.seen[0]]
    readings = Readings(image[None], np.full((1, len(points)), USUAL), points, np.zeros(len(points)))
    candidates = _candidates(fit_linear(points, image), readings, frame)
    best, readings, expected = _best(candidates, readings, frame, prior)
    suspicious = readings.std[0, 0] > SUSPICIOUS or blunders(best, readings, expected)[0].any()
    if suspicious and len(points) > SUBSET:
        candidates += _candidates(fit_linear_robust(points, image), readings, frame)
        best, _, _ = _best(candidates, readings, frame, prior)
    if not np.isfinite(best.log_mass):
        wanted = f'camera: view "{control.views[0]}": expected the images of control points in perspective'
        raise CrashkitError(f"{wanted}, found none that has them all before the camera: are points confused?")
    return best.cameras


def _candidates(linear: LinearFit, readings: Readings, frame: Frame) -> list[Cameras]:
    """The camera of the linear solution, and one with square pixels about the middle of the image."""
    general = cameras_of(linear.coefficients[None], readings.known.mean(axis=0))
    focal = general.focal * np.sqrt(np.abs(general.aspect))
    ideal = evolve(
        general, focal=focal, aspect=np.sign(general.aspect), skew=np.zeros_like(focal), centre=frame.middle.astype(float)
    )
    scale = np.where(np.arange(PARAMETERS) < POSE_AND_FOCAL, np.inf, 0.0)[None]
    posed = adjust(ideal, readings.known, readings, Expectation(ideal.numbers(), scale, np.ones_like(scale)))
    return [posed.cameras, general]


def _best(
    candidates: Sequence[Cameras], readings: Readings, frame: Frame, prior: Prior
) -> tuple[Estimate, Readings, Expectation]:
    """The most probable of what the candidates lead to."""
    readings = evolve(readings, std=np.min([first_std(camera, readings) for camera in candidates], axis=0))
    expected = expectation(prior, frame, candidates[0].focal)
    estimates = [adjust(camera, readings.known, readings, expected) for camera in candidates]
    return max(estimates, key=lambda estimate: estimate.log_mass), readings, expected
