"""Plane motion and space: analytic motions, objectivity, conservation, sensitivities."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from crashkit.errors import CrashkitError, SimulationError
from crashkit.model import Body, GivenForce, GivenMotion, Joint, Model, Parameter

AXES = {2: ("x", "y"), 3: ("x", "y", "z")}
LINEAR = {
    "elastic_stiffness": 4e4,
    "crush_force": 1e9,
    "densification_deformation": 1e3,
    "densification_stiffness": 1e3,
    "tension": 1.0,
}
"""A plateau that is never reached, of a spring that also pulls."""


@pytest.fixture(scope="session")
def simulate(simulator):
    return lambda model, times, **options: simulator(model).run(times, **options)


def numbers(**values):
    return {name: Parameter(value) for name, value in values.items()}


def body(name, position, velocity=None, mass=50.0, inertia=(2.0,), **others):
    return Body(
        name,
        tuple(position),
        tuple(velocity or (0.0,) * len(position)),
        Parameter(mass),
        inertia=tuple(map(Parameter, inertia)),
        **others,
    )


def wall(axes, **others):
    return Body("wall", (0.0,) * axes, (0.0,) * axes, fixed=True, **others)


def test_a_free_body_in_the_plane_keeps_its_speed_and_turns_steadily(simulate):
    times = np.linspace(0.0, 1.0, 11)
    free = body("free", (1.0, 2.0), (3.0, -1.0), orientation=(0.2,), angular_velocity=(5.0,))
    motion = simulate(Model("free", ("x", "z"), (free,), ()), times)
    np.testing.assert_allclose(
        motion["position"].values[:, 0], [1.0, 0.0, 2.0] + np.outer(times, [3.0, 0.0, -1.0]), atol=1e-13
    )
    np.testing.assert_allclose(motion["angular_velocity"].values[:, 0], np.tile([0.0, -5.0, 0.0], (11, 1)))
    turned = Rotation.from_quat(motion["orientation"].values[:, 0], scalar_first=True).apply([1.0, 0.0, 0.0])
    angles = 0.2 + 5.0 * times
    np.testing.assert_allclose(turned, np.stack([np.cos(angles), 0 * angles, np.sin(angles)], 1), atol=1e-13)


def test_a_free_symmetric_top_precesses_as_in_the_textbook(simulate):
    """Euler: about its own axes the transverse angular velocity turns at (I3 - I1) / I1 omega3."""
    times, rates = np.linspace(0.0, 0.5, 51), np.array([4.0, 0.0, 30.0])
    top = body("top", (0.0,) * 3, inertia=(1.0, 1.0, 1.8), angular_velocity=tuple(rates))
    motion = simulate(Model("top", AXES[3], (top,), ()), times)
    turned = Rotation.from_quat(motion["orientation"].values[:, 0], scalar_first=True)
    own = turned.inv().apply(motion["angular_velocity"].values[:, 0])
    phase = 0.8 * 30.0 * times
    np.testing.assert_allclose(own, np.stack([4 * np.cos(phase), 4 * np.sin(phase), 30 + 0 * phase], 1), rtol=1e-8, atol=1e-8)
    momentum = turned.apply(own * [1.0, 1.0, 1.8])
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (51, 1)), rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(motion["orientation"].values, axis=2), 1.0, rtol=1e-14)


def test_a_body_without_symmetry_against_eulers_equations(simulate):
    """The tumbling of the middle axis, solved with scipy in the body's frame with a full inertia."""
    inertia = np.array([[2.0, 0.1, -0.2], [0.1, 3.0, 0.3], [-0.2, 0.3, 4.0]])
    start, times = np.array([0.1, 12.0, 0.2]), np.linspace(0.0, 1.0, 21)
    tumbler = body("t", (0.0,) * 3, inertia=(2.0, 3.0, 4.0, 0.1, -0.2, 0.3), angular_velocity=tuple(start))
    motion = simulate(Model("t", AXES[3], (tumbler,), ()), times)

    def euler(t, w):
        return np.linalg.solve(inertia, -np.cross(w, inertia @ w))

    expected = solve_ivp(euler, (0.0, 1.0), start, "DOP853", times, rtol=1e-12, atol=1e-12).y.T
    turned = Rotation.from_quat(motion["orientation"].values[:, 0], scalar_first=True)
    np.testing.assert_allclose(turned.inv().apply(motion["angular_velocity"].values[:, 0]), expected, atol=1e-7)


@pytest.mark.parametrize("axes", [2, 3])
def test_a_pendulum_on_a_stiff_spring_against_scipy(simulate, axes):
    """A turning body that hangs on a point of its own, with gravity: Lagrange's equations in the plane, solved by scipy."""
    stiffness, mass, inertia, arm = 4e4, 50.0, 2.0, 0.3
    pad = (0.0,) * (axes - 2)
    hanging = body("bob", (0.4, -0.5, *pad), (0.5, 0.2, *pad), mass, (inertia,) * (1 if axes == 2 else 3))
    law = Joint("rod", ("wall", "bob"), "crush_plateau", numbers(**LINEAR), points=((0.0,) * axes, (-arm, 0.0, *pad)))
    gravity = (0.0, -9.81, *pad)
    times = np.linspace(0.0, 0.4, 41)
    motion = simulate(Model("pendulum", AXES[axes], (wall(axes), hanging), (law,), gravity=gravity), times)
    length = np.hypot(0.1, -0.5)

    def derivative(t, y):
        (x, z, angle), velocity = y[:3], y[3:]
        r = arm * np.array([-np.cos(angle), -np.sin(angle)])
        end = np.array([x, z]) + r
        distance = np.hypot(*end)
        force = stiffness * (length - distance) * end / distance
        moment = r[0] * force[1] - r[1] * force[0]
        return np.concatenate([velocity, [force[0] / mass, force[1] / mass - 9.81, moment / inertia]])

    solution = solve_ivp(derivative, (0.0, 0.4), [0.4, -0.5, 0.0, 0.5, 0.2, 0.0], "DOP853", times, rtol=1e-11, atol=1e-11).y
    np.testing.assert_allclose(motion["position"].values[:, 1, :2].T, solution[:2], atol=1e-7)
    np.testing.assert_allclose(motion["angular_velocity"].values[:, 1, 2], solution[5], atol=1e-5)


@st.composite
def crashes(draw, axes):
    """A few bodies in space or in the plane, some fixed, lines and faces between any points of any two of them."""
    count = draw(st.integers(2, 3))
    small = st.floats(-0.3, 0.3)

    def vector(numbers, scale=1.0):
        return tuple(scale * draw(numbers) for _ in range(axes))

    spin = 1 if axes == 2 else 3
    bodies = [
        body(
            f"body {i}",
            (1.5 * i, *vector(small)[1:]),
            (draw(st.floats(-10.0, 2.0)) * i, *vector(small, 5.0)[1:]),
            draw(st.floats(50.0, 500.0)),
            tuple(draw(st.floats(10.0, 15.0)) for _ in range(spin)),
            angular_velocity=tuple(draw(st.floats(-3.0, 3.0)) for _ in range(spin)),
        )
        for i in range(count)
    ]
    joints = []
    for n in range(draw(st.integers(1, 4))):
        first, second = draw(st.lists(st.integers(0, count - 1), min_size=2, max_size=2, unique=True))
        law, values = draw(
            st.sampled_from(
                [
                    ("crush_plateau", PLATEAU),
                    ("viscous", {"damping": 3e3}),
                    ("tension_spring", {"stiffness": 2e5}),
                    ("linear_stop", {"stiffness": 1e6, "stop_deformation": 0.05}),
                ]
            )
        )
        side = 1.0 if second > first else -1.0
        normal = (side, *(0.0,) * (axes - 1)) if draw(st.booleans()) else None
        joint = Joint(f"joint {n}", (f"body {first}", f"body {second}"), law, numbers(**values), (), (vector(small),) * 2)
        joints.append(joint if normal is None else Joint(*_fields(joint), normal=normal))
    return Model("random", AXES[axes], tuple(bodies), tuple(joints))


def _fields(joint):
    return joint.name, joint.bodies, joint.law, joint.parameters, joint.factors, joint.points, joint.free_length


PLATEAU = {
    "elastic_stiffness": 1e6,
    "crush_force": 5e4,
    "densification_deformation": 0.2,
    "densification_stiffness": 5e5,
    "unloading_stiffness": 3e6,
}
TIMES = np.linspace(0.0, 0.08, 801)


@pytest.mark.parametrize("axes", [2, 3])
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_bodies_exchange_momentum_and_lose_what_the_joints_take(simulate, axes, data):
    model = data.draw(crashes(axes))
    motion = simulate(model, TIMES)
    mass = np.array([entry.mass.value for entry in model.bodies])
    velocity, turning = motion["velocity"].values, motion["angular_velocity"].values
    momentum = np.einsum("b,tbi->ti", mass, velocity)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (len(TIMES), 1)), rtol=1e-9, atol=1e-7)
    turned = Rotation.from_quat(motion["orientation"].values.reshape(-1, 4), scalar_first=True)
    inertia = np.zeros((len(mass), 3))
    for i, entry in enumerate(model.bodies):
        inertia[i, 3 - len(entry.inertia) :] = [number.value for number in entry.inertia]
    own = turned.inv().apply(turning.reshape(-1, 3)).reshape(turning.shape)
    spin = turned.apply((own * inertia).reshape(-1, 3)).reshape(turning.shape)
    angular = np.sum(np.cross(motion["position"].values, mass[:, None] * velocity) + spin, axis=1)
    np.testing.assert_allclose(angular, np.tile(angular[0], (len(TIMES), 1)), rtol=1e-6, atol=1e-5)
    energy = 0.5 * np.einsum("b,tbi->t", mass, velocity**2) + 0.5 * np.einsum("tbi,tbi->t", spin, turning)
    power = (motion["force"] * motion["deformation_rate"]).sum("joint").values
    taken = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(TIMES))])
    jump = 0.5 * (TIMES[1] - TIMES[0]) * np.abs(np.diff(power)).max()  # what the sum takes wrongly where a joint begins to act
    np.testing.assert_allclose(energy + taken, energy[0], atol=3e-3 * energy[0] + jump)


@pytest.mark.parametrize("axes", [2, 3])
@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_what_happens_does_not_depend_on_where_the_observer_stands(simulate, axes, data):
    """Turn the whole model, and everything turns with it (objectivity, P1)."""
    model = data.draw(crashes(axes))
    angle = data.draw(st.floats(-3.0, 3.0))
    turn = Rotation.from_euler("z", angle) if axes == 2 else Rotation.from_rotvec([0.3 * angle, 0.5 * angle, angle])

    def turned(vector):
        return tuple(turn.apply([*vector, 0.0][:3])[:axes])

    other = Model(
        model.name,
        model.axes,
        tuple(
            body(
                b.name,
                turned(b.position),
                turned(b.velocity),
                b.mass.value,
                [number.value for number in b.inertia],
                orientation=(angle,) if axes == 2 else tuple(turn.as_quat(scalar_first=True)),
                angular_velocity=b.angular_velocity if axes == 2 else turned(b.angular_velocity),
            )
            for b in model.bodies
        ),
        model.joints,
    )
    times = TIMES[::100]
    first, second = simulate(model, times), simulate(other, times)
    scale = 1.0 + np.abs(first["force"].values).max()
    np.testing.assert_allclose(second["force"].values, first["force"].values, atol=1e-6 * scale)
    expected = turn.apply(first["position"].values.reshape(-1, 3)).reshape(first["position"].shape)
    np.testing.assert_allclose(second["position"].values, expected, atol=1e-8)


def paths_of(model, axes):
    """Parameters of every kind."""
    yield from (path for path, entry in model.parameters().items() if entry.value)
    for entry in model.bodies:
        for quantity in ("position", "velocity"):
            yield from (f"body.{entry.name}.{quantity}[{i}]" for i in range(axes))
        for quantity in ("rotation", "angular_velocity"):
            yield from (
                f"body.{entry.name}.{quantity}" + ("" if axes == 2 else f"[{i}]") for i in range(1 if axes == 2 else 3)
            )
    for joint in model.joints:
        yield from (f"joint.{joint.name}.points[{end}][{i}]" for end in range(2) for i in range(axes))


def value_of(model, path):
    """The value of any of them."""
    if path in model.parameters():
        return model.parameters()[path].value
    kind, name, quantity = path.split(".")
    if kind == "joint":
        end, axis = int(quantity[7]), int(quantity[10])
        return model.joint(name).points[end][axis]
    quantity, index = quantity.split("[")[0], int(quantity[-2]) if quantity.endswith("]") else 0
    return 0.0 if quantity == "rotation" else getattr(model.body(name), quantity)[index]


@pytest.mark.parametrize("axes", [2, 3])
@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_sensitivities_to_everything_agree_with_differences(simulate, axes, data):
    model = data.draw(crashes(axes))
    path = data.draw(st.sampled_from(list(paths_of(model, axes))))
    value, times = value_of(model, path), TIMES[::100]
    motion = simulate(model, times, sensitivities=[path])
    # Bodies that rest where they touch stand on a corner: a push either way does other things.
    assume(np.abs(motion["deformation_rate"].values[0]).min() > 1e-3)
    h = 1e-6 * max(abs(value), 0.1)
    above, below = (simulate(model, times, values={path: value + sign * h}) for sign in (1.0, -1.0))
    for name in ("position", "velocity", "angular_velocity"):
        expected = (above[name].values - below[name].values) / (2 * h)
        found = motion[f"{name}_sensitivity"].values[..., 0]
        np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max() + 1e-7 / h * 1e-3)
    quaternions = [Rotation.from_quat(m["orientation"].values.reshape(-1, 4), scalar_first=True) for m in (above, below)]
    small = (quaternions[0] * quaternions[1].inv()).as_rotvec().reshape(found.shape) / (2 * h)
    found = motion["rotation_sensitivity"].values[..., 0]
    np.testing.assert_allclose(found, small, rtol=1e-3, atol=1e-3 * np.abs(small).max() + 1e-7 / h * 1e-3)


def test_a_face_is_a_line_whose_point_lies_far_behind(simulate):
    """The force of a face acts along its normal wherever the point has slid to."""
    near = body("slider", (-0.2, 0.0), (4.0, 3.0), inertia=(2.0,))
    parameters = numbers(stiffness=1e5, stop_deformation=0.1)
    face = Joint("face", ("wall", "slider"), "linear_stop", parameters, points=((0.0, 0.0), (0.1, 0.0)), normal=(-1.0, 0.0))
    motion = simulate(Model("face", AXES[2], (wall(2), near), (face,)), TIMES)
    assert motion["force"].max() > 1e3
    np.testing.assert_allclose(motion["contact_force"].values[:, 1, 1], 0.0, atol=1e-9)
    np.testing.assert_allclose(motion["contact_force"].values[:, 1, 0], -motion["force"].values[:, 0])
    position, moment = motion["position"].values[:, 1], motion["contact_moment"].values
    angle = 2.0 * np.arctan2(motion["orientation"].values[:, 1, 3], motion["orientation"].values[:, 1, 0])
    height = position[:, 1] + 0.1 * np.sin(angle)
    np.testing.assert_allclose(moment[:, 0, 2], -height * motion["force"].values[:, 0], atol=1e-6)


def test_an_oblique_wall_pushes_along_its_normal_and_turns_the_car(simulate):
    """The wall is a body that is turned; the car's corner meets it and the car yaws."""
    car = body("car", (-2.0, 0.0), (15.0, 0.0), 1000.0, (1500.0,))
    oblique = wall(2, orientation=(np.radians(30.0),))
    face = Joint(
        "corner", ("wall", "car"), "linear_stop", numbers(stiffness=1e6, stop_deformation=0.0),
        points=((0.0, 0.0), (1.9, -0.7)), normal=(-1.0, 0.0), free_length=Parameter(0.0),
    )  # fmt: skip
    motion = simulate(Model("oblique", AXES[2], (oblique, car), (face,)), TIMES)
    force = motion["contact_force"].values[:, 1, :2]
    hit = force[np.hypot(*force.T).argmax()]
    np.testing.assert_allclose(hit / np.hypot(*hit), [-np.cos(np.radians(30.0)), -0.5], atol=1e-12)
    assert motion["angular_velocity"].values[-1, 1, 2] < -1.0


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_a_given_force_and_gravity_move_a_free_body(simulate, axes):
    force = GivenForce((0.1, 0.3), ((100.0,) + (0.0,) * (axes - 1), (300.0,) + (0.0,) * (axes - 1)))
    inertia = {1: (), 2: (2.0,), 3: (2.0, 2.0, 2.0)}[axes]
    free = body("free", (0.0,) * axes, (1.0,) + (0.0,) * (axes - 1), inertia=inertia, force=force)
    model = Model("given", ("x", "y", "z")[:axes], (free,), (), gravity=(2.0,) + (0.0,) * (axes - 1))
    times = np.array([0.05, 0.1, 0.2, 0.3, 0.5])
    motion = simulate(model, times)
    within = np.clip(times, 0.1, 0.3) - 0.1
    expected = 1.0 + 2.0 * times + (100.0 * within + 500.0 * within**2) / 50.0
    np.testing.assert_allclose(motion["velocity"].values[:, 0, 0], expected, rtol=1e-12)
    mass = simulate(model, times, sensitivities=["body.free.mass"])["velocity_sensitivity"].values[:, 0, 0, 0]
    np.testing.assert_allclose(mass, -(expected - 1.0 - 2.0 * times) / 50.0, rtol=1e-10, atol=1e-14)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_an_imposed_motion_is_followed_exactly_and_drives_the_others(simulate, axes):
    samples = np.linspace(-0.01, 0.21, 45)
    rows = np.column_stack([0.05 * np.sin(30.0 * samples), *[0.1 * samples] * (axes - 1)])
    orientation = {
        1: (),
        2: 2.0 * samples[:, None],
        3: Rotation.from_rotvec(np.outer(samples, [0, 0, 2.0])).as_quat(scalar_first=True),
    }
    imposed = GivenMotion(tuple(samples), tuple(map(tuple, rows)), tuple(map(tuple, orientation[axes])))
    driver = Body("driver", (9.0,) * axes, (9.0,) * axes, motion=imposed)
    inertia = {1: (), 2: (2.0,), 3: (2.0, 2.0, 2.0)}[axes]
    driven = body("driven", (1.0,) + (0.0,) * (axes - 1), inertia=inertia)
    spring = Joint("spring", ("driver", "driven"), "linear_stop", numbers(stiffness=1e5, stop_deformation=-10.0))
    times = np.linspace(0.0, 0.2, 21)
    motion = simulate(Model("imposed", ("x", "y", "z")[:axes], (driver, driven), (spring,)), times)
    np.testing.assert_allclose(motion["position"].values[:, 0, 0], 0.05 * np.sin(30.0 * times), atol=2e-6)
    assert np.abs(motion["velocity"].values[-1, 1]).max() > 0.1
    if axes > 1:
        turned = Rotation.from_quat(motion["orientation"].values[:, 0], scalar_first=True).as_rotvec()
        np.testing.assert_allclose(turned[:, 2], 2.0 * times, atol=1e-9)


def test_attachments_that_meet_are_a_clear_error(simulate):
    """The line between them has no direction."""
    ball = body("ball", (-0.1, 0.0), (10.0, 0.0), 1e4)
    through = Joint("line", ("wall", "ball"), "linear_stop", numbers(stiffness=1.0, stop_deformation=0.0))
    with pytest.raises(SimulationError, match="attachments of joint line between wall and ball at t = 0.01 s meet: the line"):
        simulate(Model("meet", AXES[2], (wall(2), ball), (through,)), np.linspace(0.0, 0.02, 3), step=1e-3)


def test_the_initial_state_of_a_recording(simulate):
    free = body("free", (0.0,) * 3, inertia=(1.0, 1.0, 1.0))
    half = np.sqrt(0.5)
    initial = xr.Dataset(
        {
            "position": (("body", "axis"), [[1.0, 2.0, 3.0]]),
            "velocity": (("body", "axis"), [[1.0, 0.0, 0.0]]),
            "orientation": (("body", "quaternion"), [[half, 0.0, half, 0.0]]),
            "angular_velocity": (("body", "axis"), [[0.0, 0.0, 2.0]]),
        },
        coords={"body": ["free"], "axis": ["x", "y", "z"]},
    )
    motion = simulate(Model("initial", AXES[3], (free,), ()), [0.0, 0.5], initial=initial)
    np.testing.assert_allclose(motion["orientation"].values[0, 0], [half, 0.0, half, 0.0], atol=1e-12)
    np.testing.assert_allclose(motion["position"].values[1, 0], [1.5, 2.0, 3.0], atol=1e-12)
    np.testing.assert_allclose(motion["angular_velocity"].values[1, 0], [0.0, 0.0, 2.0], atol=1e-12)


def test_a_path_that_the_model_does_not_have(simulate):
    with pytest.raises(
        CrashkitError,
        match=r'^expected a parameter of the model, found "body\.free\.position" \(did you mean "body.*position.*"\?\)$',
    ):
        simulate(Model("path", AXES[2], (body("free", (0.0, 0.0)),), ()), [1.0], sensitivities=["body.free.position"])
