"""A sparse regression of the forces that a model's joints lack along the recorded motion, as a law of its own beside them."""

import warnings

import numpy as np
import xarray as xr
from attrs import evolve
from scipy.integrate import cumulative_trapezoid

from crashkit.diagnose.show.fits import fit_of, predict
from crashkit.errors import SimulationError
from crashkit.mechanics.along import forces_along
from crashkit.mechanics.given import side_of
from crashkit.misfit import Misfit
from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.registry import load

THRESHOLDS = (0.02, 0.05, 0.1, 0.2)
"""Shares of the largest force below which a term is dropped; the one whose simulation fits the fitted runs best is taken."""
ONSET = 50.0
"""The terms are reached over the largest deformation divided by this, as a force must be continuous."""


class Cubic(SpringLaw):
    """F = min(1, 50 x) sum_k c_k p_k(x, y): all monomials up to the third degree of x = d / deepest and y = ddot / fastest."""

    name = "cubic"
    parameters = (
        ParameterSpec("coefficient", "N", "of 1, x, y, x2, x y, y2, x3, x2 y, x y2, y3", free=False, vector=True),
        ParameterSpec("deepest", "m", "largest deformation", free=False),
        ParameterSpec("fastest", "m s-1", "largest rate", free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, coefficient: list[float], deepest: float, fastest: float) -> float:
        """The force, N, compression positive."""
        if d <= 0.0:
            return 0.0
        x, y = d / deepest, ddot / fastest
        low = coefficient[0] + coefficient[1] * x + coefficient[2] * y
        square = coefficient[3] * x * x + coefficient[4] * x * y + coefficient[5] * y * y
        cube = (
            coefficient[6] * x * x * x + coefficient[7] * x * x * y + coefficient[8] * x * y * y + coefficient[9] * y * y * y
        )
        return min(1.0, ONSET * x) * (low + square + cube)


def sparse_regression(fitted: Misfit, unseen: Misfit) -> tuple[list[np.ndarray], str]:
    """Predicted samples of each held-out group, and the joint with the largest terms."""
    laws = {**load().spring_laws, Cubic.name: Cubic}
    tried = [fitted.with_model(_regressed(fitted, threshold), laws) for threshold in THRESHOLDS]
    best = min(tried, key=_left)
    sizes = {joint.name: sum(abs(c.value) for c in joint.parameters["coefficient"]) for joint in _added(best.model)}
    guilty = max(sizes, key=lambda name: sizes[name])
    told = predict(unseen.with_model(best.model, laws, best.simulator.engine))
    return [one.samples for one in told], guilty.removesuffix("_missing") if sizes[guilty] else ""


def _left(fitted: Misfit) -> float:
    """Residual over noise; infinite where the forces are such that nothing can be simulated."""
    try:
        return fit_of(fitted, predict(fitted)).normalised_rmse
    except SimulationError:
        return np.inf


def _added(model: Model) -> list[Joint]:
    return [joint for joint in model.joints if joint.law == Cubic.name]


def _regressed(fitted: Misfit, threshold: float) -> Model:
    """The model with a cubic beside each joint, by sequentially thresholded least squares of m a - F of every body."""
    from pysindy import STLSQ, PolynomialLibrary

    model = fitted.model
    motions = [_recorded(model, recording) for recording in fitted.recordings.values()]
    forces = [forces_along(model, load().spring_laws, motion) for motion in motions]
    deformation, rate = (np.concatenate([one[name] for one in forces]) for name in ("deformation", "deformation_rate"))
    deepest, fastest = np.abs(deformation).max(axis=0), np.abs(rate).max(axis=0)
    x, y = deformation / deepest, rate / fastest
    library = PolynomialLibrary(degree=3)
    columns = [np.asarray(library.fit_transform(np.column_stack(one))) for one in zip(x.T, y.T, strict=True)]
    columns = [one * np.clip(ONSET * part, 0.0, 1.0)[:, None] for one, part in zip(columns, x.T, strict=True)]
    matrix, missing = [], []
    for body in (body for body in model.bodies if body.mass is not None):
        pairs = [(m.sel(body=body.name), f.sel(body=body.name)) for m, f in zip(motions, forces, strict=True)]
        missing += [(body.mass.value * m["acceleration"] - f["contact_force"]).values[:, 0] for m, f in pairs]
        matrix.append(np.column_stack([_side(model, j, body.name) * c for j, c in zip(model.joints, columns, strict=True)]))
    size = float(max(np.abs(one["contact_force"]).max() for one in forces))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # all terms below the threshold is an answer
        fit = STLSQ(threshold=threshold, alpha=1e-3).fit(np.concatenate(matrix), np.concatenate(missing)[:, None] / size)
    rows = zip(model.joints, size * fit.coef_.reshape(len(columns), -1), deepest, fastest, strict=True)
    return evolve(model, joints=(*model.joints, *(_joint(*row) for row in rows)))


def _joint(joint: Joint, coefficient: np.ndarray, deepest: float, fastest: float) -> Joint:
    numbers = {"deepest": Parameter(float(deepest), fixed=True), "fastest": Parameter(float(fastest), fixed=True)}
    terms = tuple(Parameter(float(one), fixed=True) for one in coefficient)
    return evolve(
        joint, name=f"{joint.name}_missing", law=Cubic.name, parameters={"coefficient": terms, **numbers}, factors=()
    )


def _side(model: Model, joint: Joint, body: str) -> float:
    """In which direction a compressed joint pushes a body; 0 where it does not hold it."""
    return side_of(model, joint) * ((body == joint.bodies[1]) - (body == joint.bodies[0]))


def _recorded(model: Model, recording: xr.DataTree) -> xr.Dataset:
    """The motion of all bodies by integrating their accelerometers twice."""
    group, initial = recording.children["accelerometer"].to_dataset(), recording.children["initial"].to_dataset()
    times = group["time"].values
    motion = np.zeros((3, len(times), len(model.bodies), 1))
    for number, body in enumerate(model.bodies):
        motion[0, :, number] = body.position
        if body.fixed:
            continue
        a = group["acceleration"].values[:, group["sensor_body"].values == body.name, 0].mean(axis=1)
        x, v = (float(initial[name].sel(body=body.name).values[0]) for name in ("position", "velocity"))
        velocity = v + cumulative_trapezoid(a, times, initial=0.0)
        motion[:, :, number, 0] = x + cumulative_trapezoid(velocity, times, initial=0.0), velocity, a
    variables = {
        name: (("time", "body", "axis"), motion[n]) for n, name in enumerate(("position", "velocity", "acceleration"))
    }
    return xr.Dataset(variables, coords={"time": times, "body": [body.name for body in model.bodies], "axis": ["x"]})
