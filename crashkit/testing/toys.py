"""The paper's one- and two-degree models, with known answers (Mizzi & Jezequel 1992, eq 40 and 65-67).

The paper's are non-dimensional; here its unit of mass is 1000 kg, of length 1 m, of speed 10 m/s, and hence of time 0.1 s and
of stiffness 1e5 N/m.
"""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import define, evolve

from crashkit.mechanics import Simulator
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.protocols import SpringLaw

ALPHA, BETA, GAMMA, DELTA = 1.2, 1.2, 0.6, 0.24
RHO, ETA = 2.4, 0.7

REAR_MASS_AS_PRINTED = 1.0 / ETA
"""m' / m where eta = m / m', as the paper prints it: at speed 1 the second spring never leaves its plateau."""

REAR_MASS_INVERTED = ETA
"""m' / m the other way round: the second spring leaves its plateau at speed 1 already."""

MASS, SPEED, STIFFNESS = 1000.0, 10.0, 1e5
"""kg, m s-1, N m-1: what the paper counts as 1."""

LENGTH = 5.0
"""m between neighbours at t = 0; no spring gets as short as that."""

ROUNDING = 6
"""Decimals of a recorded position in m: an exact fit, which no measurement allows, would leave a search without an end."""


def one_degree(speed: float = 1.0) -> Model:
    """A mass that runs into a wall (eq 40).

    m x'' = -F(x), with F = alpha x up to delta, delta up to x = gamma, then delta + beta (x - gamma).

    Arguments:
        speed: at first contact, in the paper's unit.
    """
    bodies = (_wall(), _mass("front", 1.0, -LENGTH, speed))
    return Model("one degree of freedom", ("x",), bodies, (_spring("first", ("wall", "front"), 1.0),))


def two_degrees(speed: float = 1.0, rear_mass: float = REAR_MASS_AS_PRINTED) -> Model:
    """Two such systems end to end (eq 65-67).

    x1'' = -F1(x1) + (k'/m) F2(x2 - x1),  x2'' = -(k'/m') F2(x2 - x1), where k'/m' = rho = (k'/k) / (m'/m).

    Of the paper's ten parameters nine are independent: rho times alpha2, beta2 and delta2 is all that the motion sees. Here
    the nine are the two springs' four each and the rear mass; the front mass is known.

    Arguments:
        speed: at first contact, in the paper's unit.
        rear_mass: m' / m, by one reading of the paper or the other.
    """
    rear = evolve(_mass("rear", rear_mass, -2.0 * LENGTH, speed), mass=_free(rear_mass * MASS))
    joints = (_spring("first", ("wall", "front"), 1.0), _spring("second", ("front", "rear"), RHO * rear_mass))
    return Model("two degrees of freedom", ("x",), (_wall(), _mass("front", 1.0, -LENGTH, speed), rear), joints)


def start_from(model: Model, factor: float) -> Model:
    """The same model with every free parameter multiplied by `factor`: where an identification may start."""
    return model.with_values({path: factor * parameter.value for path, parameter in model.free_parameters().items()})


@define
class MotionProblem:
    """The misfit of a toy to its own motion, as an identifier sees it: no noise but rounding, and the answer is known.

    Residuals are positions of every body in every run, in mm.

    Arguments:
        simulator: of the model whose free parameters are wanted.
        names: of those parameters.
        initial: the state at t = 0, one for each run.
        times: s.
        recorded: the motion of each run, as (time, body).
        model: with the values to start from.
    """

    simulator: Simulator
    names: tuple[str, ...]
    initial: tuple[xr.Dataset, ...]
    times: np.ndarray
    recorded: tuple[np.ndarray, ...]
    model: Model

    STD: ClassVar[float] = 1e-3

    def start(self) -> np.ndarray:
        """The logarithms of the model's own values."""
        return np.log([parameter.value for parameter in self.model.free_parameters().values()])

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """The logarithms of the bounds."""
        free = self.model.free_parameters().values()
        return np.log([parameter.lower for parameter in free]), np.log([parameter.upper for parameter in free])

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """(recorded - simulated) / STD."""
        return np.concatenate([self._difference(run, self._motion(run, scaled)) for run in range(len(self.initial))])

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The residuals and their derivatives to the logarithms."""
        motions = [self._motion(run, scaled, self.names) for run in range(len(self.initial))]
        residual = np.concatenate([self._difference(run, motion) for run, motion in enumerate(motions)])
        slopes = [motion["position_sensitivity"].isel(axis=0).values.reshape(-1, len(self.names)) for motion in motions]
        return residual, -np.concatenate(slopes) / self.STD * self.scaling(scaled)

    def parameters(self, scaled: np.ndarray) -> np.ndarray:
        """The parameters themselves."""
        return np.exp(scaled)

    def scaling(self, scaled: np.ndarray) -> np.ndarray:
        """d parameter / d logarithm."""
        return np.exp(scaled)

    def _motion(self, run: int, scaled: np.ndarray, sensitivities: tuple[str, ...] = ()) -> xr.Dataset:
        values = dict(zip(self.names, np.exp(scaled).tolist(), strict=True))
        return self.simulator.run(self.times, values, initial=self.initial[run], sensitivities=sensitivities)

    def _difference(self, run: int, motion: xr.Dataset) -> np.ndarray:
        return ((self.recorded[run] - motion["position"].isel(axis=0).values) / self.STD).ravel()


def problem(
    truth: Model, start: Model, laws: Mapping[str, type[SpringLaw]], speeds: tuple[float, ...] = (1.0,)
) -> MotionProblem:
    """A search for the parameters of `truth` from the values of `start`, given its motion at some speeds."""
    simulator = Simulator(truth, laws)
    times = np.linspace(0.0, 0.6, 301)
    initial = tuple(initial_state(truth, speed) for speed in speeds)
    motions = [simulator.run(times, {}, initial=state) for state in initial]
    recorded = tuple(np.round(motion["position"].isel(axis=0).values, ROUNDING) for motion in motions)
    return MotionProblem(simulator, tuple(truth.free_parameters()), initial, times, recorded, start)


def initial_state(model: Model, speed: float) -> xr.Dataset:
    """A model's own places, and one speed, in the paper's unit, for every body that moves."""
    speeds = [[0.0 if body.fixed else speed * SPEED] for body in model.bodies]
    places = [list(body.position) for body in model.bodies]
    return xr.Dataset(
        {"position": (("body", "axis"), places, {"units": "m"}), "velocity": (("body", "axis"), speeds, {"units": "m s-1"})},
        coords={"body": [body.name for body in model.bodies], "axis": list(model.axes)},
    )


def recording(motion: xr.Dataset, title: str = "toy") -> xr.DataTree:
    """A recording of a motion without noise: film and an accelerometer on every body that moves."""
    moving = [name for name in motion["body"].values.tolist() if np.ptp(motion["position"].sel(body=name).values) > 0.0]
    seen = motion[["position", "acceleration"]].sel(body=moving).transpose("time", "body", "axis")
    return xr.DataTree.from_dict(
        {
            "/": xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": title}),
            "initial": motion[["position", "velocity"]].isel(time=0, drop=True),
            "film": _instrument(seen, "position", "marker", "m", 1e-3, {"observer": "film"}),
            "accelerometer": _instrument(
                seen,
                "acceleration",
                "sensor",
                "m s-2",
                1.0,
                {"observer": "accelerometer", "channel_frequency_class": 0, "frame": "laboratory"},
            ),
        }
    )


def _instrument(
    seen: xr.Dataset, quantity: str, channel: str, units: str, std: float, attributes: Mapping[str, object]
) -> xr.Dataset:
    """The readings at the centre of mass of each body."""
    bodies = seen["body"].values.tolist()
    return xr.Dataset(
        {
            quantity: (("time", channel, "axis"), seen[quantity].values, {"units": units}),
            f"{channel}_body": (channel, bodies),
            f"{channel}_point": ((channel, "axis"), np.zeros((len(bodies), seen.sizes["axis"])), {"units": "m"}),
            f"{quantity}_std": (channel, np.full(len(bodies), std), {"units": units}),
        },
        coords={
            "time": ("time", seen["time"].values, {"units": "s"}),
            channel: [f"{body}_{channel}" for body in bodies],
            "axis": seen["axis"].values,
        },
        attrs=dict(attributes),
    )


def _wall() -> Body:
    return Body("wall", (0.0,), (0.0,), fixed=True)


def _mass(name: str, mass: float, position: float, speed: float) -> Body:
    return Body(name, (position,), (speed * SPEED,), Parameter(mass * MASS, fixed=True))


def _spring(name: str, bodies: tuple[str, str], stiffness: float) -> Joint:
    """The reference spring, `stiffness` in the paper's unit."""
    stiffness *= STIFFNESS
    values = {
        "elastic_stiffness": ALPHA * stiffness,
        "crush_force": DELTA * stiffness,
        "densification_deformation": GAMMA,
        "densification_stiffness": BETA * stiffness,
    }
    absent = ("unloading_stiffness", "rate_coefficient", "clearance", "tension")
    parameters = {key: _free(value) for key, value in values.items()} | dict.fromkeys(absent, Parameter(0.0, fixed=True))
    return Joint(name, bodies, "crush_plateau", parameters)


def _free(value: float) -> Parameter:
    return Parameter(value, 0.1 * value, 10.0 * value)
