"""The paper's one- and two-degree models, with known answers (Mizzi & Jezequel 1992, eq 40 and 65-67).

The paper's are non-dimensional; here its unit of mass is 1000 kg, of length 1 m, of speed 10 m/s, and hence of time 0.1 s and
of stiffness 1e5 N/m.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import with_factor
from crashkit.protocols import Laws, Observer, ParameterSpec, SpringLaw

RHO, ETA = 2.4, 0.7

REAR_MASS_AS_PRINTED = 1.0 / ETA
"""m' / m where eta = m / m', as the paper prints it: at speed 1 the second spring never leaves its plateau."""

REAR_MASS_INVERTED = ETA
"""m' / m the other way round: the second spring leaves its plateau at speed 1 already."""

MASS, SPEED, STIFFNESS = 1000.0, 10.0, 1e5
"""kg, m s-1, N m-1: what the paper counts as 1."""

LENGTH = 5.0
"""m between neighbours at t = 0; no spring gets as short as that."""

TIMES = np.linspace(0.0, 0.4, 401)
"""s, of a recording: every impact is over by then."""

STEP = 5e-4
"""s, longest step of the integration of what is recorded."""

STD = {"position": 1e-3, "acceleration": 1.0}
"""m, m s-2: what recordings without noise state as their standard deviation."""

ROUNDING = 1e-3
"""Of a standard deviation, to which recordings are rounded: an exact fit, which no measurement allows, would leave a search
without an end."""


@frozen
class Spring:
    """The paper's parameters of one spring, in its unit of stiffness; the reference by default."""

    alpha: float = 1.2
    beta: float = 1.2
    gamma: float = 0.6
    delta: float = 0.24


REFERENCE = Spring()


class StiffnessRatio(SpringLaw):
    """A constant factor: with it the paper's ten parameters are all there, though only nine can be told."""

    name = "stiffness_ratio"
    unit = "1"
    parameters = (ParameterSpec("ratio", "1", "of the spring's force to that of its law (rho)", lower=1e-3),)

    @staticmethod
    def force(d: float, ddot: float, d_max: float, ratio: float) -> float:
        """The factor."""
        return ratio


def one_degree(speed: float = 1.0, spring: Spring = REFERENCE) -> Model:
    """A mass that runs into a wall (eq 40).

    m x'' = -F(x), with F = alpha x up to delta, delta up to x = gamma, then delta + beta (x - gamma).

    Arguments:
        speed: at first contact, in the paper's unit.
        spring: its parameters.
    """
    bodies = (_wall(), _mass("front", 1.0, -LENGTH, speed))
    return Model("one degree of freedom", ("x",), bodies, (_joint("first", ("wall", "front"), spring, 1.0),))


def two_degrees(
    speed: float = 1.0,
    rear_mass: float = REAR_MASS_AS_PRINTED,
    first: Spring = REFERENCE,
    second: Spring = REFERENCE,
    rho: float = RHO,
) -> Model:
    """Two such systems end to end (eq 65-67).

    x1'' = -F1(x1) + (k'/m) F2(x2 - x1),  x2'' = -(k'/m') F2(x2 - x1), where k'/m' = rho = (k'/k) / (m'/m).

    Of the paper's ten parameters nine are independent: rho times alpha2, beta2 and delta2 is all that the motion sees. Here
    the nine are the two springs' four each and the rear mass; the front mass is known.

    Arguments:
        speed: at first contact, in the paper's unit.
        rear_mass: m' / m, by one reading of the paper or the other.
        first, second: the springs' parameters.
        rho: the paper's, which multiplies the second spring.
    """
    rear = evolve(_mass("rear", rear_mass, -2.0 * LENGTH, speed), mass=_free(rear_mass * MASS))
    bodies = (_wall(), _mass("front", 1.0, -LENGTH, speed), rear)
    joints = (
        _joint("first", ("wall", "front"), first, 1.0),
        _joint("second", ("front", "rear"), second, rho * rear_mass),
    )
    return Model("two degrees of freedom", ("x",), bodies, joints)


def with_ten_parameters(model: Model, rho: float = RHO) -> Model:
    """The model of two degrees with rho as a parameter of its own, a factor of the second spring; the motion is the same.

    To be simulated with `StiffnessRatio` among the laws.
    """
    paths = [f"joint.second.{name}" for name in ("elastic_stiffness", "crush_force", "densification_stiffness")]
    known = model.parameters()
    return with_factor(
        model.with_parameters({path: _free(known[path].value / rho) for path in paths}),
        "second",
        StiffnessRatio.name,
        {"ratio": _free(rho)},
    )


def spring_of(model: Model, joint: str, stiffness: float = 1.0) -> Spring:
    """The paper's parameters of a joint, in units of `stiffness` times the paper's."""
    unit = stiffness * STIFFNESS
    value = {name: model.parameters()[f"joint.{joint}.{name}"].value for name in LAW_PARAMETERS}
    return Spring(
        value["elastic_stiffness"] / unit,
        value["densification_stiffness"] / unit,
        value["densification_deformation"],
        value["crush_force"] / unit,
    )


def start_from(model: Model, factor: float) -> Model:
    """The same model with every free parameter multiplied by `factor`: where an identification may start."""
    return model.with_values({path: factor * parameter.value for path, parameter in model.free_parameters().items()})


def problem(
    truth: Model,
    start: Model,
    laws: Laws,
    observers: Mapping[str, type[Observer]],
    speeds: tuple[float, ...] = (1.0,),
    exact: bool = False,
) -> Misfit:
    """A search for the parameters of `truth` from the values of `start`, given recordings of it at some speeds.

    Arguments:
        truth: what is recorded: there is no noise but rounding.
        start: the same model at other values.
        laws, observers: installed plugins by name.
        speeds: of the recorded tests, in the paper's unit.
        exact: not even rounded.
    """
    simulator = Simulator(truth, laws)
    motions = {f"speed_{s:g}": simulator.run(TIMES, initial=initial_state(truth, s), step=STEP) for s in speeds}
    digits = 0.0 if exact else ROUNDING
    return Misfit(start, {run: recording(motion, rounding=digits) for run, motion in motions.items()}, laws, observers)


def initial_state(model: Model, speed: float) -> xr.Dataset:
    """A model's own places, and one speed, in the paper's unit, for every body that moves."""
    speeds = [[0.0 if body.fixed else speed * SPEED] for body in model.bodies]
    places = [list(body.position) for body in model.bodies]
    return xr.Dataset(
        {"position": (("body", "axis"), places, {"units": "m"}), "velocity": (("body", "axis"), speeds, {"units": "m s-1"})},
        coords={"body": [body.name for body in model.bodies], "axis": list(model.axes)},
    )


def recording(motion: xr.Dataset, title: str = "toy", rounding: float = 0.0) -> xr.DataTree:
    """A recording of a motion without noise: film and an accelerometer on every body that moves.

    Arguments:
        motion: simulated.
        title: of the recording.
        rounding: of the readings, as a share of their standard deviation; 0: none.
    """
    moving = [name for name in motion["body"].values.tolist() if np.ptp(motion["position"].sel(body=name).values) > 0.0]
    seen = motion[["position", "acceleration"]].sel(body=moving).transpose("time", "body", "axis")
    if rounding:
        seen = seen.assign({name: _rounded(seen[name], rounding * std) for name, std in STD.items()})
    in_laboratory = {"observer": "accelerometer", "channel_frequency_class": 0, "frame": "laboratory"}
    return xr.DataTree.from_dict(
        {
            "/": xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": title}),
            "initial": motion[["position", "velocity"]].isel(time=0, drop=True),
            "film": _instrument(seen, "position", "marker", "m", {"observer": "film"}),
            "accelerometer": _instrument(seen, "acceleration", "sensor", "m s-2", in_laboratory),
        }
    )


def noisy(recording: xr.DataTree, share: float, random: np.random.Generator) -> xr.DataTree:
    """The recording with white noise on every channel, which states its standard deviation.

    Arguments:
        recording: of a toy.
        share: standard deviation of the noise, as a share of each channel's range.
        random: draws the noise.
    """
    groups = {}
    for name, quantity in (("film", "position"), ("accelerometer", "acceleration")):
        group = recording.children[name].to_dataset(inherit=False)
        clean = group[quantity]
        std = share * (clean.max("time") - clean.min("time")).isel(axis=0, drop=True)
        noise = clean.copy(data=random.normal(size=clean.shape))
        group[quantity] = (clean + std * noise).assign_attrs(clean.attrs)
        group[f"{quantity}_std"] = std.assign_attrs(clean.attrs)
        groups[name] = xr.DataTree(group)
    return recording.assign(groups)


LAW_PARAMETERS = ("elastic_stiffness", "crush_force", "densification_deformation", "densification_stiffness")
"""Of the law `crush_plateau`: alpha, delta, gamma and beta."""


def _rounded(values: xr.DataArray, step: float) -> xr.DataArray:
    return (values / step).round() * step


def _instrument(seen: xr.Dataset, quantity: str, channel: str, units: str, attributes: Mapping[str, object]) -> xr.Dataset:
    """The readings at the centre of mass of each body."""
    bodies = seen["body"].values.tolist()
    return xr.Dataset(
        {
            quantity: (("time", channel, "axis"), seen[quantity].values, {"units": units}),
            f"{channel}_body": (channel, bodies),
            f"{channel}_point": ((channel, "axis"), np.zeros((len(bodies), seen.sizes["axis"])), {"units": "m"}),
            f"{quantity}_std": (channel, np.full(len(bodies), STD[quantity]), {"units": units}),
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


def _joint(name: str, bodies: tuple[str, str], spring: Spring, stiffness: float) -> Joint:
    """A spring, `stiffness` in the paper's unit."""
    stiffness *= STIFFNESS
    values = (spring.alpha * stiffness, spring.delta * stiffness, spring.gamma, spring.beta * stiffness)
    absent = ("unloading_stiffness", "rate_coefficient", "clearance", "tension", "toe")
    free = {key: _free(value) for key, value in zip(LAW_PARAMETERS, values, strict=True)}
    return Joint(name, bodies, "crush_plateau", free | dict.fromkeys(absent, Parameter(0.0, fixed=True)))


def _free(value: float) -> Parameter:
    return Parameter(value, 0.1 * value, 10.0 * value)
