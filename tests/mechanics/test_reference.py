"""Against integrations by other means: mpmath's closed form, and scipy restarted at every corner of the laws."""

import mpmath as mp
import numpy as np
import pytest
import xarray as xr
from attrs import evolve
from scipy.integrate import solve_ivp

from crashkit.model import Body, Model, Parameter

SPRING = ("elastic_stiffness", "crush_force", "densification_deformation", "densification_stiffness", "unloading_stiffness")
VALUES = (1.2, 0.24, 0.6, 1.2, 12.0)
CLEARANCE, FREE_LENGTH, MASS, SPEED, END = 0.05, 0.9, 1.3, 1.1, 2.9
PATHS = (
    *(f"joint.spring.{name}" for name in SPRING),
    "joint.spring.clearance",
    "joint.spring.free_length",
    "body.mass.mass",
    "body.mass.position",
    "body.mass.velocity",
)
POINT = (*VALUES, CLEARANCE, FREE_LENGTH, MASS, -1.0, SPEED)


def closed_form(alpha, delta, gamma, beta, k, clearance, free_length, mass, position, speed):
    """Position and velocity at END after a gap, elastic, plateau and densified phases and the unloading line back."""
    x1 = delta / alpha
    v1 = mp.sqrt(speed**2 - alpha * x1**2 / mass)
    v2 = mp.sqrt(v1**2 - 2 * delta * (gamma - x1) / mass)
    w, wk, offset = mp.sqrt(beta / mass), mp.sqrt(k / mass), delta / beta
    amplitude = mp.sqrt(offset**2 + (v2 / w) ** 2)
    gap = (-position - free_length + clearance) / speed
    elastic = mp.asin(x1 * mp.sqrt(alpha / mass) / speed) / mp.sqrt(alpha / mass)
    plateau = mass * (v1 - v2) / delta
    densified = mp.atan2(v2 / w, offset) / w
    turn = gamma - offset + amplitude
    swing = beta * amplitude / k
    left = END - gap - elastic - plateau - densified - mp.pi / 2 / wk
    assert left > 0
    x, v = turn - swing - swing * wk * left, -swing * wk
    return x + clearance - free_length, v


@pytest.fixture
def one_degree(against_wall):
    parameters = dict(zip(SPRING, VALUES, strict=True)) | {"clearance": CLEARANCE}
    return against_wall("crush_plateau", parameters, mass=MASS, speed=SPEED, free_length=Parameter(FREE_LENGTH))


def test_one_degree_against_the_closed_form(simulator, one_degree):
    with mp.workdps(40):
        expected = [float(value) for value in closed_form(*map(mp.mpf, POINT))]
    end = simulator(one_degree).run([END], step=1e-3).sel(body="mass").isel(time=0, axis=0)
    assert [end["position"].item(), end["velocity"].item()] == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("column", range(len(PATHS)), ids=PATHS)
def test_one_degree_gradient_against_high_precision_differences(simulator, one_degree, column):
    """Thresholds, gap, masses and the memory d_max alike."""

    def at(value):
        return mp.matrix(closed_form(*[value if i == column else mp.mpf(x) for i, x in enumerate(POINT)]))

    with mp.workdps(50):
        h = mp.mpf(10) ** -20
        expected = [float(x) for x in (at(mp.mpf(POINT[column]) + h) - at(mp.mpf(POINT[column]) - h)) / (2 * h)]
    end = simulator(one_degree).run([END], sensitivities=PATHS, step=1e-3).sel(body="mass").isel(time=0, axis=0)
    found = [end[f"{name}_sensitivity"].values[column] for name in ("position", "velocity")]
    assert found == pytest.approx(expected, rel=1e-8)


def test_the_error_falls_with_the_fourth_power_of_the_step(simulator, one_degree):
    with mp.workdps(40):
        expected = float(closed_form(*map(mp.mpf, POINT))[0])
    steps = [0.1, 0.05, 0.025]
    run = simulator(one_degree).run
    errors = [abs(run([END], step=step)["position"].sel(body="mass").item() - expected) for step in steps]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders == pytest.approx([4.0, 4.0], abs=0.7)


# ---- two degrees of freedom, by scipy ----

TWO = {
    "elastic_stiffness": (1.2, 2.4),
    "crush_force": (0.24, 0.48),
    "densification_deformation": (0.6, 0.6),
    "densification_stiffness": (1.2, 2.4),
    "unloading_stiffness": (12.0, 20.0),
}
TWO_PATHS = (*(f"joint.{joint}.{name}" for joint in ("first", "second") for name in TWO), "body.front.mass", "body.rear.mass")
TWO_POINT = np.array([*(values[i] for i in range(2) for values in TWO.values()), 1.0, 0.7])
INSTANTS = np.array([0.3, 0.9, 1.7, 2.6, 3.5])


def reference(point, times=INSTANTS):
    """Positions at `times` by Dormand-Prince, restarted where a spring changes its branch; written apart from the engine."""
    springs, masses = point[:10].reshape(2, 5), point[10:]
    state, t, d_max = np.array([0.0, 0.0, 1.5, 1.5]), 0.0, np.zeros(2)
    branches = ["elastic", "elastic"]
    out = []
    while len(out) < len(times):
        events = [event for joint in range(2) for event in _events(springs[joint], branches[joint], joint, d_max)]
        solution = solve_ivp(
            _slope,
            (t, times[-1]),
            state,
            method="DOP853",
            rtol=1e-13,
            atol=1e-15,
            args=(springs, masses, branches, d_max),
            events=[event for event, _, _ in events],
            dense_output=True,
        )
        out += [solution.sol(instant)[:2] for instant in times if t <= instant < solution.t[-1] or instant == solution.t[-1]]
        t, state = solution.t[-1], solution.y[:, -1].copy()
        for (_, joint, branch), found in zip(events, solution.t_events, strict=True):
            if len(found):
                if branch == "unloading":
                    d_max = d_max.copy()
                    d_max[joint] = _deformations(state)[0][joint]
                branches = [branch if i == joint else old for i, old in enumerate(branches)]
    return np.array(out)


def _deformations(y):
    return (y[0], y[1] - y[0]), (y[2], y[3] - y[2])


def _load(spring, d):
    alpha, delta, gamma, beta, _ = spring
    return alpha * d if d * alpha < delta else delta if d < gamma else delta + beta * (d - gamma)


def _slope(t, y, springs, masses, branches, d_max):
    forces = []
    for spring, branch, d, largest in zip(springs, branches, _deformations(y)[0], d_max, strict=True):
        alpha, delta, gamma, beta, k = spring
        laws = {
            "elastic": alpha * d,
            "plateau": delta,
            "densified": delta + beta * (d - gamma),
            "unloading": _load(spring, largest) - k * (largest - d),
            "open": 0.0,
        }
        forces.append(laws[branch])
    return [y[2], y[3], (forces[1] - forces[0]) / masses[0], -forces[1] / masses[1]]


def _events(spring, branch, joint, d_max):
    alpha, delta, gamma, beta, k = spring
    foot = d_max[joint] - _load(spring, d_max[joint]) / k
    after = "elastic" if d_max[joint] * alpha < delta else "plateau" if d_max[joint] < gamma else "densified"

    def reaches(level, direction, to):
        def event(t, y, *others):
            return _deformations(y)[0][joint] - level

        event.terminal, event.direction = True, direction
        return event, joint, to

    def turns(t, y, *others):
        return _deformations(y)[1][joint]

    turns.terminal, turns.direction = True, -1
    turn = (turns, joint, "unloading")
    return {
        "elastic": [reaches(delta / alpha, 1, "plateau"), turn],
        "plateau": [reaches(gamma, 1, "densified"), turn],
        "densified": [turn],
        "unloading": [reaches(foot, -1, "open"), reaches(d_max[joint], 1, after)],
        "open": [reaches(foot, 1, "unloading")],
    }[branch]


@pytest.fixture
def two_degrees(joint):
    def spring(name, bodies, i):
        return joint(name, bodies, "crush_plateau", {key: values[i] for key, values in TWO.items()})

    return Model(
        "two degrees",
        ("x",),
        (
            Body("wall", (0.0,), (0.0,), fixed=True),
            Body("front", (-1.0,), (1.5,), Parameter(1.0)),
            Body("rear", (-2.0,), (1.5,), Parameter(0.7)),
        ),
        (spring("first", ("wall", "front"), 0), spring("second", ("front", "rear"), 1)),
    )


def test_two_degrees_against_scipy(simulator, two_degrees):
    motion = simulator(two_degrees).run(INSTANTS, step=1e-3)
    found = motion["position"].sel(body=["front", "rear"]).isel(axis=0).values + [1.0, 2.0]
    np.testing.assert_allclose(found, reference(TWO_POINT), atol=1e-10)


def test_two_degrees_gradient_against_scipy(simulator, two_degrees):
    motion = simulator(two_degrees).run(INSTANTS, sensitivities=TWO_PATHS, step=1e-3)
    found = motion["position_sensitivity"].sel(body=["front", "rear"]).isel(axis=0).values
    for column, path in enumerate(TWO_PATHS):
        h = 4e-3 * TWO_POINT[column] * np.eye(len(TWO_POINT))[column]
        wide, narrow = ((reference(TWO_POINT + x) - reference(TWO_POINT - x)) / (2 * x.sum()) for x in (h, h / 2))
        expected = (4 * narrow - wide) / 3
        np.testing.assert_allclose(found[:, :, column], expected, atol=2e-8 * (1.0 + np.abs(expected).max()), err_msg=path)


def test_a_far_smaller_step_gives_the_same_motion(simulator, two_degrees):
    coarse, fine = (simulator(two_degrees).run(INSTANTS, step=step) for step in (4e-3, 4e-3 / 64))
    np.testing.assert_allclose(coarse["position"].values, fine["position"].values, atol=1e-9)
    np.testing.assert_allclose(coarse["force"].values, fine["force"].values, atol=1e-8)


def test_irregular_output_times_give_the_same_motion(simulator, two_degrees):
    random = np.random.default_rng(3)
    irregular = np.unique(np.concatenate([INSTANTS, np.sort(random.uniform(0.0, 3.5, 700))]))
    sparse, dense = (simulator(two_degrees).run(times, step=2e-3) for times in (INSTANTS, irregular))
    again = dense.isel(time=np.searchsorted(irregular, INSTANTS))
    np.testing.assert_allclose(again["position"].values, sparse["position"].values, atol=1e-10)


def test_initial_state_of_a_recording(simulator, two_degrees):
    initial = xr.Dataset(
        {"position": (("body", "axis"), [[-3.0]]), "velocity": (("body", "axis"), [[1.2]])},
        coords={"body": ["rear"], "axis": ["x"]},
    )
    rear = evolve(two_degrees.body("rear"), position=(-3.0,), velocity=(1.2,))
    moved = evolve(two_degrees, bodies=(*two_degrees.bodies[:2], rear))
    found, expected = simulator(two_degrees).run(INSTANTS, initial=initial), simulator(moved).run(INSTANTS)
    assert found.identical(expected)
