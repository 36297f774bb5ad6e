"""Forces that jump: the motion, and its sensitivities across the jump (saltation), against solutions in closed form."""

from typing import ClassVar

import mpmath as mp
import numpy as np
import pytest
from attrs import evolve

from crashkit.mechanics import Simulator, compile_engine, functions_of
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.protocols import ParameterSpec, SpringLaw

STEP = 1e-3
TIMES = np.linspace(0.0, 2.0, 21)
LIMIT = 0.5
NUDGE = 1e-30
"""Of a complex step, whose derivative has no rounding error."""


def harmonic(x, v, omega, t):
    """Position and velocity of a free oscillation after t."""
    if omega == 0:
        return x + v * t, v
    return x * mp.cos(omega * t) + v / omega * mp.sin(omega * t), v * mp.cos(omega * t) - x * omega * mp.sin(omega * t)


def broken(t, stiffness, limit, loss, mass, speed):
    """The way of a mass whose strut breaks at `limit`."""
    omega = mp.sqrt(stiffness / mass)
    at = mp.asin(limit * omega / speed) / omega
    if t < at:
        return harmonic(0, speed, omega, t)[0]
    x, v = harmonic(0, speed, omega, at)
    return harmonic(x, v, mp.sqrt((1 - loss) * stiffness / mass), t - at)[0]


def derivatives(way, t, values):
    """Of a way to each of its arguments, by differences of 30 digits."""
    with mp.workdps(30):
        numbers = [mp.mpf(value) for value in values]
        orders = [tuple(int(i == k) for i in range(len(values))) for k in range(len(values))]
        return [float(mp.diff(lambda *p: way(mp.mpf(t), *p), numbers, order)) for order in orders]


def compare(motion, way, values, paths):
    expected = np.array([derivatives(way, t, values) for t in TIMES])
    found = motion["position_sensitivity"].sel(body="mass", parameter=paths).values[:, 0]
    np.testing.assert_allclose(found, expected, atol=1e-8)
    ways = [float(way(mp.mpf(t), *map(mp.mpf, values))) for t in TIMES]
    np.testing.assert_allclose(motion["position"].sel(body="mass").values[:, 0] + 1.0, ways, atol=1e-10)


@pytest.mark.parametrize("loss", [0.7, 1.0])
def test_a_strut_that_breaks(simulator, against_wall, loss):
    values = {"stiffness": 1.3, "fracture_deformation": LIMIT, "loss": loss}
    model = against_wall("brittle", values, mass=1.2)
    paths = [*(f"joint.spring.{name}" for name in values), "body.mass.mass", "body.mass.velocity"]
    if loss == 1.0:  # beyond it the square root of a stiffness below 0 is not real
        paths.remove("joint.spring.loss")
    motion = simulator(model).run(TIMES, sensitivities=paths, step=STEP)
    given = [*values.values(), 1.2, 1.0]
    if loss == 1.0:
        compare(motion, lambda t, k, x, m, v: broken(t, k, x, 1, m, v), [1.3, LIMIT, 1.2, 1.0], paths)
    else:
        compare(motion, broken, given, paths)


def test_a_factor_that_breaks_a_spring(simulator, against_wall):
    values = {"stiffness": 1.3, "stop_deformation": 0.0, "fracture_deformation": LIMIT, "loss": 0.7}
    model = against_wall("linear_stop", values, mass=1.2, factors=("fracture",))
    names = ("joint.spring.stiffness", "joint.spring.fracture_deformation", "joint.spring.loss", "body.mass.mass")
    motion = simulator(model).run(TIMES, sensitivities=[*names, "body.mass.velocity"], step=STEP)
    compare(motion, broken, [1.3, LIMIT, 0.7, 1.2, 1.0], [*names, "body.mass.velocity"])


def test_a_break_is_for_good(simulator, against_wall):
    """Thrown back by what is left, and pressed again by nobody, the mass keeps the energy of the softer spring."""
    model = against_wall("brittle", {"stiffness": 1.3, "fracture_deformation": LIMIT, "loss": 0.7})
    motion = simulator(model).run(np.linspace(0.0, 8.0, 81), step=STEP)
    lost = 0.7 * 1.3 * LIMIT**2 / 2.0
    assert motion["velocity"].sel(body="mass").values[-1, 0] == pytest.approx(-np.sqrt(1.0 - 2.0 * lost), rel=1e-9)


def test_struts_that_break_together_are_told_apart(simulator, against_wall, joint):
    """Two equal struts break at once: each threshold has its own part in what follows."""

    def way(t, first, second):
        omega = mp.sqrt(mp.mpf(1.3))
        at, x, v, k, m = mp.mpf(0), mp.mpf(0), mp.mpf(1), mp.mpf(1.3), 1
        for limit in sorted((first, second)):
            omega = mp.sqrt(k / m)
            amplitude = mp.sqrt(x**2 + (v / omega) ** 2)
            then = (mp.asin(limit / amplitude) - mp.asin(x / amplitude)) / omega
            if at + then > t:
                break
            x, v = harmonic(x, v, omega, then)
            at, k = at + then, k - mp.mpf(0.7) * mp.mpf(1.3) / 2
        return harmonic(x, v, mp.sqrt(k / m), t - at)[0]

    half = {"stiffness": 0.65, "fracture_deformation": LIMIT, "loss": 0.7}
    struts = tuple(joint(name, ("wall", "mass"), "brittle", half) for name in ("left", "right"))
    model = evolve(against_wall("brittle", half), joints=struts)
    paths = ["joint.left.fracture_deformation", "joint.right.fracture_deformation"]
    motion = simulator(model).run(TIMES, sensitivities=paths, step=STEP)
    compare(motion, way, [LIMIT, LIMIT], paths)


class Lossy(SpringLaw):
    """Loses a share of its force where it turns round."""

    name = "lossy"
    jumps = True
    parameters: ClassVar = (ParameterSpec("k", "N m-1", "slope"), ParameterSpec("kept", "1", "share kept"))

    @staticmethod
    def force(d, ddot, d_max, k, kept):
        pressed = max(0.0, d)
        return kept * k * pressed if d < d_max else k * pressed


class Slowing(SpringLaw):
    """Loses a share of its force below a rate."""

    name = "slowing"
    jumps = True
    parameters: ClassVar = (*Lossy.parameters, ParameterSpec("limit", "m s-1", "rate"))

    @staticmethod
    def force(d, ddot, d_max, k, kept, limit):
        pressed = max(0.0, d)
        return k * pressed if ddot > limit else kept * k * pressed


class Worn(SpringLaw):
    """Loses a share of its force once so much work is done on it."""

    name = "worn"
    memory = "work"
    jumps = True
    parameters: ClassVar = (*Lossy.parameters, ParameterSpec("limit", "J", "work"))

    @staticmethod
    def force(d, ddot, d_max, work, k, kept, limit):
        return kept * k * d if work > limit else k * d

    @staticmethod
    def memory_rate(d, ddot, d_max, work, k, kept, limit):
        return k * d * ddot


STRANGE = {law.name: law for law in (Lossy, Slowing, Worn)}


@pytest.fixture(scope="module")
def strange(against_wall):
    parameters = {"k": 1.3, "kept": 0.3, "limit": 0.6}
    models = {
        name: against_wall(name, {spec.name: parameters[spec.name] for spec in law.parameters}, mass=1.2)
        for name, law in STRANGE.items()
    }
    models["worn"] = models["worn"].with_values({"joint.spring.limit": 0.2})
    engine = compile_engine(frozenset().union(*(functions_of(model, STRANGE) for model in models.values())))
    return {name: Simulator(model, STRANGE, engine) for name, model in models.items()}


def softened(t, at, omega, kept, speed):
    """The way of a mass whose spring keeps a share of its stiffness from some time on."""
    if t < at:
        return harmonic(0, speed, omega, t)[0]
    return harmonic(*harmonic(0, speed, omega, at), omega * mp.sqrt(kept), t - at)[0]


def lossy(t, k, kept, m, v):
    omega = mp.sqrt(k / m)
    return softened(t, mp.pi / 2 / omega, omega, kept, v)


def slowing(t, k, kept, limit, m, v):
    omega = mp.sqrt(k / m)
    return softened(t, mp.acos(limit / v) / omega, omega, kept, v)


def worn(t, k, kept, limit, m, v):
    omega = mp.sqrt(k / m)
    return softened(t, mp.asin(mp.sqrt(2 * limit / k) * omega / v) / omega, omega, kept, v)


@pytest.mark.parametrize("way", [lossy, slowing, worn], ids=lambda way: way.__name__)
def test_a_jump_at_the_turn_at_a_rate_and_of_a_memory(strange, way):
    simulator = strange[way.__name__]
    parameters = {path: parameter.value for path, parameter in simulator.model.parameters().items()}
    names = [path for path in parameters if path.startswith("joint")] + ["body.mass.mass"]
    motion = simulator.run(TIMES, sensitivities=[*names, "body.mass.velocity"], step=STEP)
    compare(motion, way, [*(parameters[name] for name in names), 1.0], [*names, "body.mass.velocity"])


@pytest.mark.parametrize("name", STRANGE)
def test_the_adjoint_of_a_jump_at_the_turn_at_a_rate_and_of_a_memory(strange, check_adjoint, name):
    paths = [*strange[name].model.parameters(), "body.mass.velocity", "body.mass.position"]
    check_adjoint(strange[name], TIMES, paths, STEP)


def test_the_adjoint_of_struts_that_break_together(simulator, against_wall, joint, check_adjoint):
    half = {"stiffness": 0.65, "fracture_deformation": LIMIT, "loss": 0.7}
    struts = tuple(joint(name, ("wall", "mass"), "brittle", half) for name in ("left", "right"))
    model = evolve(against_wall("brittle", half), joints=struts)
    check_adjoint(simulator(model), TIMES, [*model.parameters(), "body.mass.velocity"], STEP)


def test_the_adjoint_of_a_factor_that_breaks(simulator, against_wall, check_adjoint):
    values = {"stiffness": 1.3, "stop_deformation": 0.0, "fracture_deformation": LIMIT, "loss": 0.7}
    model = against_wall("linear_stop", values, mass=1.2, factors=("fracture",))
    check_adjoint(simulator(model), TIMES, [*model.parameters(), "body.mass.velocity"], STEP)


# ---- plane motion ----

PLANE = {
    "joint.strut.stiffness": 1.3,
    "joint.strut.fracture_deformation": 0.3,
    "joint.strut.loss": 0.6,
    "joint.strut.free_length": 0.95,
    "joint.strut.points[1][1]": 0.3,
    "body.mass.mass": 1.2,
    "body.mass.inertia": 0.4,
    "body.mass.velocity[0]": 1.0,
    "body.mass.rotation": 0.1,
    "body.mass.angular_velocity": 0.2,
}


@pytest.fixture(scope="module")
def plane(simulator):
    strut = {name: Parameter(PLANE[f"joint.strut.{name}"]) for name in ("stiffness", "fracture_deformation", "loss")}
    wall = Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True)
    mass = Body(
        "mass",
        (-1.0, 0.05),
        (1.0, 0.1),
        Parameter(1.2),
        inertia=(Parameter(0.4),),
        orientation=(0.1,),
        angular_velocity=(0.2,),
    )
    joint = Joint("strut", ("wall", "mass"), "brittle", strut, points=((0.0, 0.2), (0.1, 0.3)), free_length=Parameter(0.95))
    return simulator(Model("plane", ("x", "y"), (wall, mass), (joint,), gravity=(0.0, -0.3)))


def test_a_break_in_the_plane(plane):
    motion = plane.run(TIMES, sensitivities=list(PLANE), step=STEP)
    late = slice(10, None, 9)
    reference = np.array([[in_the_plane(t, path) for path in PLANE] for t in TIMES[late]])
    found = motion["position_sensitivity"].sel(body="mass", axis=["x", "y"]).values[late].transpose(0, 2, 1)
    np.testing.assert_allclose(found, reference[:, :, :2], atol=1e-8)
    turned = motion["rotation_sensitivity"].sel(body="mass", axis="z").values[late]
    np.testing.assert_allclose(turned, reference[:, :, 2], atol=1e-8)


def in_the_plane(t, path):
    """Derivative of (x, y, angle) at t to a parameter, by a complex step through the break and its time."""
    p = {name: value + (1j * NUDGE if name == path else 0.0) for name, value in PLANE.items()}
    start = np.array([-1.0, 0.05, p["body.mass.rotation"], p["body.mass.velocity[0]"], 0.1, p["body.mass.angular_velocity"]])
    at = 0.4 + 0j
    for _ in range(8):
        state = flow(start, at, p, 1.0)
        d, ddot = deformation(state, p)
        at -= (d - p["joint.strut.fracture_deformation"]) / ddot
    assert 0.0 < at.real < t
    return (flow(flow(start, at, p, 1.0), t - at, p, 1.0 - p["joint.strut.loss"]).imag / NUDGE)[:3]


def arms(state, p):
    """From the wall's attachment to the mass's, and the arm of the latter."""
    x, y, angle = state[:3]
    px, py = 0.1, p["joint.strut.points[1][1]"]
    arm = np.array([np.cos(angle) * px - np.sin(angle) * py, np.sin(angle) * px + np.cos(angle) * py])
    return np.array([x, y]) + arm - np.array([0.0, 0.2]), arm


def deformation(state, p):
    line, arm = arms(state, p)
    length = np.sqrt(line @ line)
    velocity = state[3:5] + state[5] * np.array([-arm[1], arm[0]])
    return p["joint.strut.free_length"] - length, -(line @ velocity) / length


def flow(state, duration, p, share, steps=400):
    """The motion for a while, whose length may be complex, with a share of the strut's stiffness."""

    def slope(y):
        line, arm = arms(y, p)
        d = deformation(y, p)[0]
        pressed = d if d.real > 0.0 else 0.0 * d
        force = share * p["joint.strut.stiffness"] * pressed * line / np.sqrt(line @ line)
        moment = arm[0] * force[1] - arm[1] * force[0]
        pulled = force / p["body.mass.mass"] + np.array([0.0, -0.3])
        return np.concatenate([y[3:], pulled, [moment / p["body.mass.inertia"]]])

    h, y = duration / steps, state.astype(complex)
    for _ in range(steps):
        a = slope(y)
        b = slope(y + 0.5 * h * a)
        c = slope(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * (b + c) + slope(y + h * c))
    return y
