"""Laws with a memory that is integrated: relaxation, tearing, hysteresis."""

import mpmath as mp
import numpy as np
import pytest
from attrs import evolve
from scipy.integrate import solve_ivp
from scipy.special import erf

from crashkit.mechanics import Simulator
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.registry.law_book import LawBook
from crashkit_spring_laws import BoucWen

STEP = 1e-3
TIMES = np.linspace(0.0, 3.0, 16)
K, TAU, MASS, SPEED = 1.3, 0.4, 1.2, 1.0


def relaxing(t, k, tau, m, v, elastic=0):
    """Deformation, rate and memory of a Maxwell element, beside an elastic spring, that a mass presses: linear equations."""
    system = mp.matrix([[0, 1, 0], [-(k + elastic) / m, 0, k / m], [1 / tau, 0, -1 / tau]])
    return mp.expm(system * t) * mp.matrix([0, v, 0])


def relaxed(*arguments):
    """Its deformation."""
    return relaxing(*arguments)[0]


def derivatives(way, t, values):
    with mp.workdps(30):
        numbers = [mp.mpf(value) for value in values]
        orders = [tuple(int(i == k) for i in range(len(values))) for k in range(len(values))]
        return [float(mp.diff(lambda *p: way(mp.mpf(t), *p), numbers, order)) for order in orders]


PATHS = ["joint.spring.relaxing_stiffness", "joint.spring.relaxation_time", "body.mass.mass", "body.mass.velocity"]


@pytest.fixture(scope="module")
def maxwell(against_wall):
    parameters = {"relaxing_stiffness": K, "relaxation_time": TAU, "tension": 1.0}
    return against_wall("maxwell", parameters, mass=MASS, speed=SPEED)


def test_maxwell_against_its_solution(simulator, maxwell):
    motion = simulator(maxwell).run(TIMES, step=STEP)
    expected = [float(relaxed(mp.mpf(t), K, TAU, MASS, SPEED)) for t in TIMES]
    np.testing.assert_allclose(motion["deformation"].values[:, 0], expected, atol=1e-11)


def test_the_sensitivities_of_maxwell(simulator, maxwell):
    motion = simulator(maxwell).run(TIMES, sensitivities=PATHS, step=STEP)
    expected = [derivatives(relaxed, t, [K, TAU, MASS, SPEED]) for t in TIMES]
    np.testing.assert_allclose(motion["deformation_sensitivity"].values[:, 0], expected, atol=1e-8)


def test_maxwell_that_only_pushes_lets_go(simulator, against_wall):
    """With a slow dashpot its force swings back to zero before the deformation does; from then on the mass flies."""
    values, times = [K, 2.0, MASS, SPEED], np.linspace(0.0, 5.0, 11)
    model = against_wall("maxwell", {"relaxing_stiffness": K, "relaxation_time": 2.0}, mass=MASS, speed=SPEED)
    motion = simulator(model).run(times, sensitivities=PATHS, step=STEP)

    def way(t, k, tau, m, v):
        gone = mp.pi / mp.sqrt(k / m - 1 / (4 * tau**2))
        x, rate, _ = relaxing(min(t, gone), k, tau, m, v)
        return x + max(0, t - gone) * rate

    expected = [float(way(mp.mpf(t), *map(mp.mpf, values))) for t in times]
    np.testing.assert_allclose(motion["deformation"].values[:, 0], expected, atol=1e-10)
    apart = motion.sel(time=3.5)
    assert apart["force"].item() == 0.0 < apart["deformation"].item()
    slopes = [derivatives(way, t, values) for t in times]
    np.testing.assert_allclose(motion["deformation_sensitivity"].values[:, 0], slopes, atol=1e-8)


def test_a_gap_delays_the_relaxation(simulator, against_wall):
    near = {"relaxing_stiffness": K, "relaxation_time": TAU}
    late, early = (simulator(against_wall("maxwell", near | {"clearance": gap})) for gap in (0.5, 0.0))
    motion, other = late.run(TIMES + 0.5, step=STEP), early.run(TIMES, step=STEP)
    np.testing.assert_allclose(motion["force"].values, other["force"].values, atol=1e-10)


def test_beside_an_elastic_law_it_is_the_standard_linear_solid(laws, against_wall):
    """Either in a joint of its own or in the same one."""
    parameters = {"stiffness": 0.7, "stop_deformation": 0.0, "relaxing_stiffness": K, "relaxation_time": TAU}
    one = against_wall("linear_stop | maxwell", parameters, mass=MASS)
    joint = one.joints[0]
    apart = [
        evolve(
            joint,
            name=law,
            law=law,
            parameters={s.name: joint.parameters[s.name] for s in laws[law].parameters if s.name in parameters},
        )
        for law in ("linear_stop", "maxwell")
    ]
    motions = [Simulator(model, LawBook(laws)).run(TIMES[:6], step=STEP) for model in (one, evolve(one, joints=tuple(apart)))]
    expected = [float(relaxed(mp.mpf(t), K, TAU, MASS, SPEED, mp.mpf("0.7"))) for t in TIMES[:6]]
    for motion in motions:
        np.testing.assert_allclose(motion["deformation"].values[:, 0], expected, atol=1e-11)


def test_two_memories_in_one_model(simulator, against_wall, joint):
    """Two Maxwell elements side by side: each has a memory of its own."""
    halves = [(0.5 * K, TAU), (0.5 * K, TAU)]
    joints = tuple(
        joint(name, ("wall", "mass"), "maxwell", {"relaxing_stiffness": k, "relaxation_time": tau, "tension": 1.0})
        for name, (k, tau) in zip("ab", halves, strict=True)
    )
    model = against_wall("maxwell", {"relaxing_stiffness": K, "relaxation_time": TAU, "tension": 1.0}, mass=MASS)
    motion = simulator(evolve(model, joints=joints)).run(TIMES, sensitivities=["joint.a.relaxing_stiffness"], step=STEP)
    whole = simulator(model).run(TIMES, sensitivities=["joint.spring.relaxing_stiffness"], step=STEP)
    np.testing.assert_allclose(motion["position"].values, whole["position"].values, atol=1e-12)
    expected = whole["position_sensitivity"].values
    np.testing.assert_allclose(motion["position_sensitivity"].values, expected, atol=1e-10)


# ---- tearing ----

TORN = {"stiffness": 1.3, "tear_extension": 0.5, "loss": 0.7, "duration": 0.2}


def torn(t, k, limit, loss, duration, m, v):
    """Extension of a spring that tears: an oscillation, a decay of its stiffness, and another oscillation."""
    omega = mp.sqrt(k / m)
    at = mp.asin(limit * omega / v) / omega
    if t < at:
        return v / omega * mp.sin(omega * t)
    slope = lambda s, y: [y[1], -k / m * (1 - loss * s / duration) * y[0]]  # noqa: E731
    tearing = mp.odefun(slope, 0, [limit, v * mp.cos(omega * at)])
    if t < at + duration:
        return tearing(t - at)[0]
    (x, speed), left = tearing(duration), omega * mp.sqrt(1 - loss)
    since = t - at - duration
    return x * mp.cos(left * since) + speed / left * mp.sin(left * since)


def test_a_tension_spring_that_tears(simulator, against_wall):
    model = against_wall("tension_spring", TORN, mass=MASS, speed=-SPEED, factors=("tear",))
    paths = [*(f"joint.spring.{name}" for name in TORN), "body.mass.mass"]
    motion = simulator(model).run([0.6, 1.5], sensitivities=paths, step=STEP)
    values = [*TORN.values(), MASS, SPEED]
    with mp.workdps(20):
        expected = [-float(torn(mp.mpf(t), *map(mp.mpf, values))) for t in (0.6, 1.5)]
        slopes = [derivatives(torn, t, values)[:-1] for t in (0.6, 1.5)]
    np.testing.assert_allclose(motion["deformation"].values[:, 0], expected, atol=1e-11)
    np.testing.assert_allclose(motion["deformation_sensitivity"].values[:, 0], -np.array(slopes), atol=1e-8)


# ---- hysteresis ----


def test_a_member_that_yields_both_ways(simulator, against_wall):
    """Thrown against its spring, the mass swings back and forth and loses its energy in loops."""
    values = {"stiffness": 40.0, "yield_force": 3.0, "hardening": 0.05, "sharpness": 2.0}
    model = against_wall("bouc_wen", values, mass=MASS, speed=2.0)
    times = np.linspace(0.0, 6.0, 61)
    motion = simulator(model).run(times, step=STEP)

    def slope(t, y):
        d, ddot, z = y
        force = BoucWen.force(d, ddot, 0.0, z, *values.values())
        return [ddot, -force / MASS, BoucWen.memory_rate(d, ddot, 0.0, z, *values.values())]

    reference = solve_ivp(slope, (0.0, 6.0), [0.0, 2.0, 0.0], "DOP853", times, rtol=1e-12, atol=1e-12)
    d = motion["deformation"].values[:, 0]
    np.testing.assert_allclose(d, reference.y[0], atol=1e-7)
    assert np.count_nonzero(np.diff(np.sign(motion["deformation_rate"].values[:, 0]))) >= 4
    assert np.abs(motion["force"].values).max() < 3.0 + 0.05 * 40.0 * np.abs(d).max()


def test_the_sensitivities_of_hysteresis(simulator, against_wall):
    values = {"stiffness": 40.0, "yield_force": 3.0, "hardening": 0.05, "sharpness": 2.0}
    run = simulator(against_wall("bouc_wen", values, mass=MASS, speed=2.0)).run
    times = np.linspace(0.0, 3.0, 11)
    motion = run(times, sensitivities=[f"joint.spring.{name}" for name in values], step=STEP)
    for name, value in values.items():
        path, h = f"joint.spring.{name}", 1e-3 * value
        near, far = (
            (run(times, {path: value + s}, step=STEP)["position"] - run(times, {path: value - s}, step=STEP)["position"])
            / (2 * s)
            for s in (h, 2.0 * h)
        )
        expected = ((4.0 * near - far) / 3.0).values
        found = motion["position_sensitivity"].sel(parameter=path).values
        np.testing.assert_allclose(found, expected, atol=2e-6 * np.abs(expected).max())


# ---- plane motion ----


def test_a_memory_in_the_plane(simulator):
    """A line that turns, with a Maxwell element on it: the same as a model of mp.odefun."""
    maxwell = {
        name: Parameter(value) for name, value in {"relaxing_stiffness": K, "relaxation_time": TAU, "tension": 1.0}.items()
    }
    wall = Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True)
    mass = Body("mass", (-1.0, 0.0), (0.5, 0.4), Parameter(MASS), inertia=(Parameter(0.4),))
    joint = Joint("line", ("wall", "mass"), "maxwell", maxwell, free_length=Parameter(1.0))
    model = Model("plane", ("x", "y"), (wall, mass), (joint,))
    paths = ["joint.line.relaxing_stiffness", "joint.line.relaxation_time", "body.mass.velocity[1]", "joint.line.free_length"]
    motion = simulator(model).run([1.0], sensitivities=paths, step=STEP)

    def way(k, tau, v, length):
        def slope(t, y):
            r = mp.sqrt(y[0] ** 2 + y[1] ** 2)
            pull = k * (length - r - y[4]) / (MASS * r)
            return [y[2], y[3], pull * y[0], pull * y[1], (length - r - y[4]) / tau]

        return mp.odefun(slope, 0, [-1, 0, mp.mpf("0.5"), v, 0])(1)[:2]

    with mp.workdps(20):
        given = [mp.mpf(K), mp.mpf(TAU), mp.mpf("0.4"), mp.mpf(1)]
        expected = [float(value) for value in way(*given)]
        nudges = [[g + (i == n) * mp.mpf("1e-7") * s for i, g in enumerate(given)] for n in range(4) for s in (1, -1)]
        ends = [way(*nudged) for nudged in nudges]
        slopes = [
            [float((a - b) / mp.mpf("2e-7")) for a, b in zip(*pair, strict=True)]
            for pair in zip(ends[::2], ends[1::2], strict=True)
        ]
    np.testing.assert_allclose(motion["position"].sel(body="mass").values[0, :2], expected, atol=1e-10)
    found = motion["position_sensitivity"].sel(body="mass").values[0, :2]
    np.testing.assert_allclose(found, np.array(slopes).T, atol=1e-8)


# ---- bristles ----

BRISTLES = {"friction_force": 0.3, "bristle_length": 0.2}


def test_bristles_take_the_work_that_they_should(against_wall, simulator):
    """On the way in, m (v0^2 - v^2) / 2 is the integral of F (1 - exp(-x / l)); a body that is too slow turns round."""
    model = against_wall("dahl", BRISTLES, mass=MASS, speed=SPEED)
    motion = simulator(model).run(TIMES, step=STEP)
    deformation, rate = (motion[name].values[:, 0] for name in ("deformation", "deformation_rate"))
    assert rate.min() > 0.0
    force, length = BRISTLES.values()
    work = force * (deformation - length * (1.0 - np.exp(-deformation / length)))
    np.testing.assert_allclose(0.5 * MASS * (SPEED**2 - rate**2), work, atol=1e-8)


def test_bristles_bend_back_before_they_slip_the_other_way(against_wall, simulator):
    """A spring sends the body back: from where it turned, z goes from z0 to (1 + z0) exp(-x / l) - 1."""
    springs = against_wall("dahl", BRISTLES, mass=MASS, speed=SPEED)
    stop = {"stiffness": Parameter(4.0), "stop_deformation": Parameter(0.0)}
    back = Joint("back", springs.joints[0].bodies, "linear_stop", stop)
    model = evolve(springs, joints=(*springs.joints, back))
    motion = simulator(model).run(np.linspace(0.0, 1.6, 1601), step=STEP)
    deformation, bristle = (motion[name].sel(joint="spring").values for name in ("deformation", "force"))
    turn = int(np.argmax(deformation))
    z, way = bristle / BRISTLES["friction_force"], deformation[turn] - deformation
    expected = (1.0 + z[turn]) * np.exp(-way / BRISTLES["bristle_length"]) - 1.0
    assert way[-1] > 0.3
    np.testing.assert_allclose(z[turn:], expected[turn:], atol=1e-4)


def test_a_force_of_the_time_changes_the_momentum_by_its_impulse(simulator, against_wall):
    """Each bump's impulse is half of its height times its width times sqrt(pi), between the values of erf at its ends."""
    heights, duration = [0.2, -0.1, 0.3, 0.05], 2.0
    pushed = against_wall("time_table", {"heights": heights, "duration": duration}, mass=MASS, speed=-SPEED)
    times = np.linspace(0.0, duration, 9)
    motion = simulator(pushed).run(times, step=STEP)
    apart, wide = duration / len(heights), 0.8 * duration / len(heights)
    ends = [(erf((times - (i + 0.5) * apart) / wide) + erf((i + 0.5) * apart / wide)) for i in range(len(heights))]
    impulse = 0.5 * np.sqrt(np.pi) * wide * np.array(heights) @ np.array(ends)
    np.testing.assert_allclose(motion["deformation_rate"].values[:, 0], -SPEED - impulse / MASS, atol=1e-9)
