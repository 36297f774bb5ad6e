"""Which experiment would separate two rivals, and by how many sigma."""

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.campaign import spread
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.model import Body

FASTER = 1.2
BALLAST = 0.3
"""Of a body's mass."""
SEPARATED = 3.0
"""Sigma."""
READING = 0.02
"""Noise of a further instrument, in its largest reading."""
INTERVAL = 1e-3
"""s between its independent readings."""
FURTHER = {"contact_force": ("force", "a load cell"), "acceleration": ("acceleration", "an accelerometer")}
"""By quantity of a motion: what an instrument that shows it records, and what it is called."""


@frozen
class Duel:
    """Two fitted models before an experiment.

    Arguments:
        best, rival: their misfits to the fastest run.
        information: (parameter, parameter) what all runs told of the rival's parameters, as search variables.
    """

    best: Misfit
    rival: Misfit
    information: np.ndarray

    @classmethod
    def of(cls, best: Misfit, rival: Misfit) -> "Duel":
        """Of two fits to the same runs."""
        fastest = max(best.recordings, key=lambda run: _speed(best.recordings[run]))
        jacobian = rival.residual_and_jacobian(rival.start())[1]
        return cls(best.with_recordings((fastest,)), rival.with_recordings((fastest,)), jacobian.T @ jacobian)

    @property
    def run(self) -> str:
        """The fastest."""
        return next(iter(self.best.recordings))

    def sigma(self, difference: np.ndarray, jacobian: np.ndarray) -> float:
        """How far apart the predictions are that the rival cannot come nearer by other values of its parameters.

        sigma^2 = d' (1 + J A^-1 J')^-1 d = d'd - d'J (A + J'J)^-1 J'd

        Arguments:
            difference: d, (reading,) in units of noise.
            jacobian: J, (reading, parameter) of the rival's predictions to its search variables; A is `information`.
        """
        known = self.information + jacobian.T @ jacobian
        size = np.sqrt(np.diag(known))
        size = np.where(size > 0.0, size, 1.0)  # parameters have units of their own
        drawn = jacobian.T @ difference / size
        taken_up = drawn @ np.linalg.pinv(known / np.outer(size, size), hermitian=True) @ drawn
        return float(np.sqrt(max(difference @ difference - taken_up, 0.0)))


def experiment(best: Misfit, rival: Misfit, name: str, bodies: Sequence[Body]) -> str:
    """The same test, faster; where that hardly tells two fitted models apart, what would do better.

    Arguments:
        best, rival: fitted to the same runs.
        name: of the rival.
        bodies: that can carry ballast or an instrument.
    """
    duel = Duel.of(best, rival)
    speed = _speed(best.recordings[duel.run])
    if speed == 0.0:
        return ""
    sigma = _repeated(duel, duel.best.at_speed(FASTER), duel.rival.at_speed(FASTER))
    faster = f"the same test at {FASTER * speed:.1f} m/s"
    if sigma > SEPARATED:
        return f"{faster} would separate this from {name}: {sigma:.0f} sigma"
    heavy = [body for body in bodies if body.mass is not None]
    others = [*spread(partial(_heavier, duel), heavy), *_further_instruments(duel, bodies)]
    what, most = max(others, key=lambda one: one[1], default=("", 0.0))
    if most > SEPARATED:
        return f"{what} would separate this from {name}: {most:.0f} sigma; {faster} hardly: {sigma:.0f} sigma"
    tried = f"{faster}, more mass and a further instrument"
    return f"no test that was tried would separate this from {name}: {tried} give at most {max(sigma, most):.0f} sigma"


def _repeated(duel: Duel, best: Misfit, rival: Misfit) -> float:
    """Sigma of the same instruments in another test; 0 where it cannot be simulated."""
    try:
        jacobian = rival.residual_and_jacobian(rival.start())[1]
        difference = best.discrepancy(best.start()) - rival.discrepancy(rival.start())
    except SimulationError:
        return 0.0
    return duel.sigma(difference, -jacobian[: len(difference)])


def _heavier(duel: Duel, body: Body) -> tuple[str, float]:
    """The same test with ballast on one body."""
    assert body.mass is not None
    more = BALLAST * body.mass.value
    pair = [one.with_values(_ballasted(one, body.name, more)) for one in (duel.best, duel.rival)]
    return f"the same with {more:.3g} kg more on {body.name}", _repeated(duel, *pair)


def _ballasted(misfit: Misfit, body: str, more: float) -> dict[str, float]:
    path = f"body.{body}.mass"
    return {path: misfit.model.parameters()[path].value + more}


def _further_instruments(duel: Duel, bodies: Sequence[Body]) -> Iterator[tuple[str, float]]:
    """The same test with one more instrument."""
    motions = [one.predictor.motion(duel.run, one.values(one.start()), True) for one in (duel.best, duel.rival)]
    for body in bodies:
        quantity = "contact_force" if body.fixed else "acceleration"
        recorded, called = FURTHER[quantity]
        if body.name not in _watched(duel.best, recorded):
            yield f"{called} on {body.name}", _read(duel, motions, quantity, body.name)


def _watched(misfit: Misfit, quantity: str) -> set[str]:
    """The bodies on which an instrument records a quantity."""
    groups = [group for group in misfit.groups if group.observer.quantity == quantity]
    return {str(body) for group in groups for body in group.dataset[f"{group.observer.channel}_body"].values}


def _read(duel: Duel, motions: Sequence[xr.Dataset], quantity: str, body: str) -> float:
    """Sigma of what one instrument would read of a body."""
    times = motions[0]["time"].values
    rows = np.unique(np.searchsorted(times, np.arange(times[0], times[-1], INTERVAL)))
    first, second = (motion[quantity].sel(body=body).values[rows].ravel() for motion in motions)
    noise = READING * np.abs(first).max(initial=0.0)
    if noise == 0.0:
        return 0.0
    columns = [duel.rival.names.index(path) for path in motions[1]["parameter"].values.tolist()]
    changes = motions[1][f"{quantity}_sensitivity"].sel(body=body).values[rows]
    jacobian = np.zeros((first.size, len(duel.rival.names)))
    jacobian[:, columns] = changes.reshape(first.size, -1) * duel.rival.scaling(duel.rival.start())[columns]
    return duel.sigma((first - second) / noise, jacobian / noise)


def _speed(recording: xr.DataTree) -> float:
    initial = recording.children.get("initial")
    return float(np.abs(initial.to_dataset()["velocity"].values).max()) if initial is not None else 0.0
