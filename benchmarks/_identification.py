"""What a user would write without crashkit: scipy's integrators inside scipy's or lmfit's optimisers, for the paper's toys."""

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec

import numpy as np
from attrs import frozen
from scipy.integrate import solve_ivp
from scipy.optimize import differential_evolution, least_squares

from crashkit.misfit import Group, Misfit

MASS = 1000.0
"""kg, of the front body, which is known."""


@frozen
class Peer:
    """A peer's method: the integrator with its tolerance, and the relative step of its differences."""

    name: str
    integrator: str
    tolerance: float
    difference: float | None = None

    def fit(self, misfit: Misfit, first: np.ndarray) -> np.ndarray:
        """The parameters from a start."""
        residual = _residual(misfit, self.integrator, self.tolerance)
        lower, upper = (misfit.parameters(bound) for bound in misfit.bounds())
        within = np.clip(first, lower, upper)
        return np.asarray(least_squares(residual, within, bounds=(lower, upper), x_scale=within, diff_step=self.difference).x)


PEERS = (
    Peer("scipy least_squares, RK45 1e-3", "RK45", 1e-3),
    Peer("scipy least_squares, RK45 1e-6, step 1e-4", "RK45", 1e-6, 1e-4),
    Peer("scipy least_squares, RK45 1e-9", "RK45", 1e-9),
    Peer("scipy least_squares, RK45 1e-9, step 1e-5", "RK45", 1e-9, 1e-5),
    Peer("scipy least_squares, LSODA 1e-9, step 1e-5", "LSODA", 1e-9, 1e-5),
)


@frozen
class Lmfit:
    """lmfit's `minimize`, MINPACK's Levenberg-Marquardt on bounded parameters, over the same residuals."""

    name: str = "lmfit minimize, RK45 1e-9, step 1e-5"

    @property
    def is_installed(self) -> bool:
        """Whether it can be asked."""
        return find_spec("lmfit") is not None

    def fit(self, misfit: Misfit, first: np.ndarray) -> np.ndarray:
        """The parameters from a start, each in units of its start."""
        lmfit = import_module("lmfit")
        residual, (lower, upper) = _residual(misfit, "RK45", 1e-9), map(misfit.parameters, misfit.bounds())
        within, unknown = np.clip(first, lower, upper), lmfit.Parameters()
        for number, (value, low, high) in enumerate(zip(within, lower, upper, strict=True)):
            unknown.add(f"p{number}", value=1.0, min=low / value, max=high / value)
        found = lmfit.minimize(lambda p: residual(within * np.array(list(p.valuesdict().values()))), unknown, epsfcn=1e-10)
        return np.asarray(within * np.array(list(found.params.valuesdict().values())))


LMFIT = Lmfit()


def evolved(misfit: Misfit, seed: int) -> np.ndarray:
    """What 20 generations of differential evolution, polished, find within half and one and a half times the true values."""
    residual = _residual(misfit, "RK45", 1e-6)
    truth = misfit.parameters(misfit.start())
    bounds = list(zip(0.5 * truth, 1.5 * truth, strict=True))

    def cost(values: np.ndarray) -> float:
        return float(np.sum(residual(values) ** 2))

    return np.asarray(differential_evolution(cost, bounds, maxiter=20, seed=seed).x)


def _residual(misfit: Misfit, integrator: str, tolerance: float) -> Callable[[np.ndarray], np.ndarray]:
    """Weighted residuals of film and accelerometers, as crashkit's."""
    names, predictor = misfit.names, misfit.predictor
    runs = []
    for run, recording in misfit.recordings.items():
        groups = [group for group in misfit.groups if group.run == run]
        initial = recording.children["initial"].to_dataset(inherit=False)
        moving = [str(body) for body in initial["body"].values if str(body) != "wall"]
        runs.append((groups, [float(initial["velocity"].sel(body=body).values[0]) for body in moving]))
    start = {body.name: body.position[0] for body in predictor.model.bodies}

    def residual(values: np.ndarray) -> np.ndarray:
        known = dict(zip(names, values.tolist(), strict=True))
        parts = [_read(groups, speeds, known, start, integrator, tolerance) for groups, speeds in runs]
        return np.concatenate(parts)

    return residual


def _read(
    groups: list[Group],
    speeds: list[float],
    known: dict[str, float],
    start: dict[str, float],
    integrator: str,
    tolerance: float,
) -> np.ndarray:
    times, slopes = groups[0].times, _motion(known, len(speeds))
    first = [0.0] * len(speeds) + speeds
    answer = solve_ivp(slopes, (0.0, times[-1]), first, integrator, times, rtol=tolerance, atol=1e-3 * tolerance)
    if answer.y.shape[1] < len(times):
        return np.full(2 * len(speeds) * len(times), 1e6)
    count = len(speeds)
    places = np.array([start[name] for name in ("front", "rear")[:count]])
    accelerations = np.array([slopes(0.0, state)[count:] for state in answer.y.T])
    shown = {"position": answer.y[:count].T + places, "acceleration": accelerations}
    return np.concatenate(
        [
            ((group.recorded - shown[group.observer.quantity]) * [channel.noise.weight for channel in group.channels]).ravel()
            for group in groups
        ]
    )


def _motion(known: dict[str, float], count: int) -> Callable[[float, np.ndarray], list[float]]:
    """The equations of motion of one or two bodies behind one another."""
    law = [[known[f"joint.{joint}.{name}"] for name in NAMES] for joint in ("first", "second")[:count]]
    rear, ratio = known.get("body.rear.mass", np.nan), known.get("joint.second.ratio", 1.0)

    def one(t: float, state: np.ndarray) -> list[float]:
        return [state[1], -_force(state[0], law[0]) / MASS]

    def two(t: float, state: np.ndarray) -> list[float]:
        first, second = _force(state[0], law[0]), ratio * _force(state[1] - state[0], law[1])
        return [state[2], state[3], (second - first) / MASS, -second / rear]

    return one if count == 1 else two


NAMES = ("elastic_stiffness", "crush_force", "densification_deformation", "densification_stiffness")


def _force(x: float, law: list[float]) -> float:
    """The paper's spring (Mizzi & Jezequel 1992, eq 40)."""
    alpha, delta, gamma, beta = law
    if x <= 0.0:
        return 0.0
    return min(alpha * x, delta) + beta * max(0.0, x - max(gamma, delta / alpha))
