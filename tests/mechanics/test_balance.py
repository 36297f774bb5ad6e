"""Energy and momentum over random multigraphs of bodies and joints."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from crashkit.model import Body, Model, Parameter

TIMES = np.arange(0.0, 0.1, 2.5e-5)


SPEEDS = st.just(0.0) | st.floats(0.01, 16.0)


@st.composite
def springs(draw):
    """A law with its parameters, of any family."""
    return draw(
        st.sampled_from(
            [
                ("crush_plateau", {**_plateau(draw), "unloading_stiffness": draw(st.floats(2e6, 6e6))}),
                ("crush_plateau", {**_plateau(draw), "clearance": draw(st.floats(0.0, 0.1)), "rate_coefficient": 0.02}),
                ("piecewise_affine", {"deformation": [0.02, 0.1, 0.3], "force": [8e4, 5e4, 2e5], "unloading_stiffness": 5e6}),
                ("linear_stop", {"stiffness": 1e6, "stop_deformation": draw(st.floats(0.0, 0.2))}),
                ("viscous", {"damping": draw(st.floats(0.0, 1e4))}),
                ("coulomb", {"friction_force": draw(st.floats(0.0, 2e4))}),
                ("tension_spring", {"stiffness": 2e5}),
                ("peak", {"peak_force": 5e4, "peak_deformation": draw(st.floats(0.02, 0.2))}),
                ("folding", {"amplitude": 2e4, "fold_length": draw(st.floats(0.05, 0.2))}),
            ]
        )
    )


def _plateau(draw):
    return {
        "elastic_stiffness": draw(st.floats(5e5, 2e6)),
        "crush_force": draw(st.floats(3e4, 2e5)),
        "densification_deformation": draw(st.floats(0.05, 0.4)),
        "densification_stiffness": draw(st.floats(1e5, 1e6)),
    }


@st.composite
def structures(draw):
    """Bodies on a line, and joints between any two of them, several between the same two among them."""
    count = draw(st.integers(2, 4))
    fixed = draw(st.booleans())
    bodies = [(f"body {i}", draw(st.floats(50.0, 900.0)), -0.8 * i, draw(SPEEDS), fixed and i == 0) for i in range(count)]
    pair = st.lists(st.integers(0, count - 1), min_size=2, max_size=2, unique=True)
    return bodies, draw(st.lists(st.tuples(pair, springs()), min_size=1, max_size=5))


def assemble(structure, joint):
    bodies, links = structure
    return Model(
        "random",
        ("x",),
        tuple(Body(n, (x,), (v,), None if fixed else Parameter(m), fixed) for n, m, x, v, fixed in bodies),
        tuple(
            joint(f"joint {i}", (bodies[a][0], bodies[b][0]), law, parameters)
            for i, ((a, b), (law, parameters)) in enumerate(links)
        ),
    )


SUDDEN_STOP = (
    [("body 0", 50.0, -0.0, 0.0, False), ("body 1", 50.0, -0.8, 0.01, False)],
    [([0, 1], ("coulomb", {"friction_force": 2e4}))],
)
"""Between two instants."""


@settings(max_examples=40, deadline=None)
@given(structures())
@example(SUDDEN_STOP)
def test_what_the_bodies_lose_the_joints_take(simulator, joint, structure):
    model = assemble(structure, joint)
    motion = simulator(model).run(TIMES)
    mass = np.array([body.mass.value if body.mass else 0.0 for body in model.bodies])
    kinetic = 0.5 * motion["velocity"].values[:, :, 0] ** 2 @ mass
    power = (motion["force"] * motion["deformation_rate"]).sum("joint").values
    absorbed, with_half = _integral(power, TIMES)[::2], _integral(power[::2], TIMES[::2])
    # Friction that stops a slow body does so between a few instants: what half of them say tells how well all say it.
    unsure = np.abs(absorbed - with_half)
    assert np.all(np.abs(kinetic[::2] + absorbed - kinetic[0]) < 1e-3 * kinetic[0] + 1e-9 + unsure)


def _integral(rate, times):
    """By trapezoids, from the first instant to each."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times))])


@settings(max_examples=40, deadline=None)
@given(structures())
def test_passive_joints_end_with_no_less_than_they_began(simulator, joint, structure):
    model = assemble(structure, joint)
    motion = simulator(model).run(TIMES[::40])
    mass = np.array([body.mass.value if body.mass else 0.0 for body in model.bodies])
    kinetic = 0.5 * motion["velocity"].values[:, :, 0] ** 2 @ mass
    assert np.all(kinetic <= kinetic[0] * (1.0 + 1e-9))


@settings(max_examples=40, deadline=None)
@given(structures())
def test_joints_exchange_momentum_and_make_none(simulator, joint, structure):
    model = assemble(structure, joint)
    motion = simulator(model).run(TIMES[::40])
    mass = np.array([body.mass.value if body.mass else 0.0 for body in model.bodies])
    scale = np.abs(motion["contact_force"].values).max() + 1.0
    np.testing.assert_allclose(motion["contact_force"].sum("body").values, 0.0, atol=1e-12 * scale)
    if not any(body.fixed for body in model.bodies):
        momentum = motion["velocity"].values[:, :, 0] @ mass
        np.testing.assert_allclose(momentum, momentum[0], rtol=1e-11, atol=1e-9)


@settings(max_examples=15, deadline=None)
@given(structures(), st.data())
def test_sensitivities_agree_with_differences(simulator, joint, structure, data):
    """Of the velocity, to any parameter; a difference across a change in the order of events is of first order only."""
    model = assemble(structure, joint)
    run = simulator(model).run
    path = data.draw(st.sampled_from([path for path, entry in model.parameters().items() if entry.value > 0.0]))
    value, times = model.parameters()[path].value, TIMES[::400]
    motion = run(times, sensitivities=[path])
    found = motion["velocity_sensitivity"].values[:, :, 0, 0] * value
    above, below = (run(times, {path: value * (1.0 + h)})["velocity"].values[:, :, 0] for h in (1e-5, -1e-5))
    expected = (above - below) / 2e-5
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3 * (1.0 + np.abs(expected).max()))
