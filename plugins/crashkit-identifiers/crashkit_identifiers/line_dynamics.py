"""A model in one axis as a differential equation that can be left and entered anywhere, with its derivatives."""

import numpy as np
import xarray as xr
from attrs import define

from crashkit.mechanics.given import side_of
from crashkit.mechanics.joint_law import JointLaw
from crashkit.misfit import Misfit
from crashkit_identifiers.recorded import engine_of, laws_of

Rows = tuple[int | None, int | None]
INSTANT = np.zeros(1)
"""Any: only memories tell one from another."""


@define
class _Spring:
    """A joint: the rows among those that move (None: fixed) of its bodies and of those that it pushes, and its geometry."""

    law: JointLaw
    bodies: Rows
    pushed: Rows
    side: float
    rest: float
    columns: list[int]
    largest: float = 0.0

    @property
    def signs(self) -> tuple[float, float]:
        """In which direction it pushes either body."""
        return -self.side, self.side


class LineDynamics:
    """X' = F(X, U) of one run, with X the positions and then the velocities of the bodies that move.

    It remembers the largest deformations so far, so it goes forward only.

    Arguments:
        misfit: of a model in one axis.
        motion: measured, which says where the bodies are at t = 0.

    Attributes:
        count: of bodies that move.
    """

    def __init__(self, misfit: Misfit, motion: xr.Dataset) -> None:
        self.misfit = misfit
        model, laws = misfit.model, laws_of(misfit)
        self._moving = [body.name for body in model.bodies if not body.fixed]
        self.count = len(self._moving)
        self._values = model.values()
        start = dict(zip([b.name for b in model.bodies], motion["position"].values[0, :, 0].tolist(), strict=True))
        self._still = {body.name: body.position[0] for body in model.bodies if body.fixed}
        self._springs = []
        for joint in model.joints:
            law, points = JointLaw(joint, laws, engine_of(misfit)).without_memory(), joint.points or ((0.0,), (0.0,))
            apart = start[joint.bodies[1]] + points[1][0] - start[joint.bodies[0]] - points[0][0]
            side = side_of(model, joint)
            length = side * apart if joint.free_length is None else joint.free_length.value
            # A deformation is this less the distance of the two centres of mass, along the side.
            rest = length - side * (points[1][0] - points[0][0])
            rest -= side * (self._still.get(joint.bodies[1], 0.0) - self._still.get(joint.bodies[0], 0.0))
            columns = [misfit.names.index(path) if path in misfit.names else -1 for path in law.paths]
            self._springs.append(_Spring(law, self._rows(joint.bodies), self._rows(joint.pushed), side, rest, columns))

    def _rows(self, pair: tuple[str, str]) -> Rows:
        first, second = (self._moving.index(name) if name in self._moving else None for name in pair)
        return first, second

    def measured(self, motion: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
        """The measured states (time, 2 count), and the standard deviation of each entry."""
        own = motion.sel(body=self._moving).isel(axis=0)
        states = np.hstack([own["position"].values, own["velocity"].values])
        noise = [np.sqrt(np.nanmean(own[f"{name}_std"].values ** 2, axis=0)) for name in ("position", "velocity")]
        return states, np.concatenate(noise)

    def advance(self, state: np.ndarray, point: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
        """The state one step later, by Runge and Kutta's classical method, and the transition of state and parameters."""
        values = {**self._values, **self.misfit.values(point)}
        scaling, size = self.misfit.scaling(point), 2 * self.count
        tangent = np.eye(size, size + len(point))
        sums, tangent_sums = np.zeros(size), np.zeros_like(tangent)
        slope, tangent_slope = np.zeros(size), np.zeros_like(tangent)
        for ahead, weight in ((0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)):
            there, tangent_there = state + ahead * step * slope, tangent + ahead * step * tangent_slope
            acceleration, by_state, by_parameter = self._accelerations(there, values)
            slope = np.concatenate([there[self.count :], acceleration])
            tangent_slope = np.vstack([tangent_there[self.count :], by_state @ tangent_there])
            tangent_slope[self.count :, size:] += by_parameter * scaling
            sums += weight / 6.0 * slope
            tangent_sums += weight / 6.0 * tangent_slope
        state = state + step * sums
        for spring in self._springs:
            spring.largest = max(spring.largest, self._deformation(spring, state)[0])
        transition = np.eye(size + len(point))
        transition[:size] = tangent + step * tangent_sums
        return state, transition

    def _accelerations(self, state: np.ndarray, values: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """m s-2 by body, and their derivatives to the state and to the parameters."""
        force = np.zeros(self.count)
        by_state, by_parameter = np.zeros((self.count, 2 * self.count)), np.zeros((self.count, len(self.misfit.names)))
        for spring in self._springs:
            push, slopes, senses = self._push(spring, state, values)
            for row, sign in zip(spring.pushed, spring.signs, strict=True):
                if row is None:
                    continue
                force[row] += sign * push
                for sensed, by_d, by_rate in senses:
                    for other, against in zip(sensed.bodies, sensed.signs, strict=True):
                        if other is not None:
                            by_state[row, other] -= sign * against * by_d
                            by_state[row, self.count + other] -= sign * against * by_rate
                for column, slope in zip(spring.columns, slopes, strict=True):
                    if column >= 0:
                        by_parameter[row, column] += sign * slope
        masses = np.array([values[f"body.{name}.mass"] for name in self._moving])
        for row, name in enumerate(self._moving):
            if f"body.{name}.mass" in self.misfit.names:
                by_parameter[row, self.misfit.names.index(f"body.{name}.mass")] = -force[row] / masses[row]
        return force / masses, by_state / masses[:, None], by_parameter / masses[:, None]

    def _push(
        self, spring: _Spring, state: np.ndarray, values: dict[str, float]
    ) -> tuple[float, np.ndarray, list[tuple[_Spring, float, float]]]:
        """N, its derivatives to the law's parameters, and to the deformation and rate of each spring that it depends on."""
        d, rate = self._deformation(spring, state)
        largest, numbers = max(spring.largest, d), spring.law.numbers(values)
        drivers = [one for one in self._springs if one.law.joint.name == spring.law.joint.driver]
        drive = np.array([[*self._deformation(drivers[0], state), 0.0]]) if drivers else None
        own = np.array([[d, rate, largest]])
        modes = spring.law.modes(INSTANT, own, numbers, drive)
        (push,), (slopes,), (driven,) = spring.law.evaluate(INSTANT, own, modes, numbers, drive)
        by_d = slopes[0] + (slopes[2] if d >= largest else 0.0)
        return push, slopes[3:], [(spring, by_d, slopes[1]), *((one, *driven) for one in drivers)]

    def _deformation(self, spring: _Spring, state: np.ndarray) -> tuple[float, float]:
        """m and m s-1."""
        d, rate = spring.rest, 0.0
        for row, sign in zip(spring.bodies, (spring.side, -spring.side), strict=True):
            if row is not None:
                d += sign * state[row]
                rate += sign * state[self.count + row]
        return float(d), float(rate)
