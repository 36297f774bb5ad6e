"""Model files in the plane and in space: what they may say, and what each fault is told as."""

import math

import numpy as np
import pytest

from crashkit.model import GivenForce, GivenMotion, Parameter
from crashkit.model.toml import model_to_toml

PLANE = """\
schema = "crashkit-model/1"
name = "car and barrier"
axes = ["x", "y"]
gravity = [0.0, -9.81]

[[body]]
name = "barrier"
fixed = true
position = [0.0, 0.0]
orientation = 0.5

[[body]]
name = "car"
mass = 1000.0
inertia = 1500.0
position = [-2.0, 0.0]
orientation = 0.1
velocity = [15.0, 0.0]
angular_velocity = 0.2

[[joint]]
name = "front"
bodies = ["barrier", "car"]
points = [[0.0, 0.0], [2.0, 0.5]]
normal = [-1.0, 0.0]
law = "linear"
[joint.parameters]
stiffness = 1.1e6
"""

SPACE = (
    PLANE.replace('axes = ["x", "y"]', 'axes = ["x", "y", "z"]')
    .replace("[0.0, -9.81]", "[0.0, 0.0, -9.81]")
    .replace("[0.0, 0.0]\n", "[0.0, 0.0, 0.0]\n")
    .replace("[-2.0, 0.0]", "[-2.0, 0.0, 0.0]")
    .replace("[15.0, 0.0]", "[15.0, 0.0, 0.0]")
    .replace("orientation = 0.5", "orientation = [1.0, 0.0, 0.0, 0.0]")
    .replace("orientation = 0.1", "orientation = [0.6, 0.0, 0.0, 0.8]")
    .replace("angular_velocity = 0.2", "angular_velocity = [0.0, 0.0, 0.2]")
    .replace("inertia = 1500.0", "inertia = [400.0, 1400.0, 1500.0]")
    .replace("points = [[0.0, 0.0], [2.0, 0.5]]", "points = [[0.0, 0.0, 0.0], [2.0, 0.5, 0.0]]")
    .replace("normal = [-1.0, 0.0]", "normal = [-1.0, 0.0, 0.0]")
)

MOTION = """\
[[body]]
name = "sled"
[body.motion]
time = [0.0, 0.1, 0.2]
position = [[5.0, 0.0], [6.0, 0.1], [7.0, 0.4]]
orientation = [0.0, 0.1, 0.2]
"""

FORCE = """\
[body.force]
time = [0.0, 0.1]
force = [[0.0, 10.0], [0.0, 0.0]]
moment = [3.0, 0.0]
"""
"""Of the body of the table before."""


def in_plane(old: str, new: str) -> str:
    assert old in PLANE
    return PLANE.replace(old, new)


def in_space(old: str, new: str) -> str:
    assert old in SPACE
    return SPACE.replace(old, new)


class TestReading:
    def test_the_plane(self, read):
        model = read(PLANE)
        car, front = model.body("car"), model.joint("front")
        assert (model.axes, model.gravity) == (("x", "y"), (0.0, -9.81))
        assert (car.inertia, car.orientation, car.angular_velocity) == ((Parameter(1500.0, fixed=True),), (0.1,), (0.2,))
        assert model.body("barrier").orientation == (0.5,)
        assert (front.points, front.normal) == (((0.0, 0.0), (2.0, 0.5)), (-1.0, 0.0))

    def test_space(self, read):
        model = read(SPACE)
        car = model.body("car")
        assert [entry.value for entry in car.inertia] == [400.0, 1400.0, 1500.0]
        assert (car.orientation, car.angular_velocity) == ((0.6, 0.0, 0.0, 0.8), (0.0, 0.0, 0.2))
        assert list(model.parameters())[:4] == ["body.car.mass", *(f"body.car.inertia[{index}]" for index in range(3))]

    def test_what_is_omitted(self, read):
        text = (
            in_plane("orientation = 0.1\n", "").replace("angular_velocity = 0.2\n", "").replace("normal = [-1.0, 0.0]\n", "")
        )
        model = read(text.replace("gravity = [0.0, -9.81]\n", ""))
        car = model.body("car")
        assert (car.orientation, car.angular_velocity, car.motion, car.force) == ((), (), None, None)
        assert (model.gravity, model.joint("front").normal) == ((), None)

    def test_moments_of_inertia_with_bounds(self, read):
        free = "{ value = 1500.0, upper = 2000.0 }"
        assert read(in_plane("1500.0", free)).body("car").inertia == (Parameter(1500.0, 0.0, 2000.0),)
        six = f"[400.0, 1400.0, {free}, {{ value = 10.0, lower = -20.0 }}, 0.0, -5.0]"
        assert [entry.value for entry in read(in_space("[400.0, 1400.0, 1500.0]", "900.0")).body("car").inertia] == [900.0] * 3
        inertia = read(in_space("[400.0, 1400.0, 1500.0]", six)).body("car").inertia
        assert inertia[2:4] == (Parameter(1500.0, 0.0, 2000.0), Parameter(10.0, -20.0))
        assert inertia[5] == Parameter(-5.0, fixed=True)

    def test_unit_vectors_are_normalised(self, read):
        front = read(in_plane("normal = [-1.0, 0.0]", "normal = [-0.8660254, 0.5]")).joint("front")
        car = read(in_space("[0.6, 0.0, 0.0, 0.8]", "[0.70710678, 0.0, 0.0, 0.70710678]")).body("car")
        assert front.normal == pytest.approx((-math.cos(math.pi / 6), 0.5), abs=1e-8)
        assert math.hypot(*front.normal) == pytest.approx(1.0, abs=1e-15)
        assert math.hypot(*car.orientation) == pytest.approx(1.0, abs=1e-15)

    def test_a_given_motion(self, read):
        sled = read(PLANE + MOTION).body("sled")
        assert sled.motion == GivenMotion((0.0, 0.1, 0.2), ((5.0, 0.0), (6.0, 0.1), (7.0, 0.4)), ((0.0,), (0.1,), (0.2,)))
        assert (sled.mass, sled.inertia, sled.position, sled.velocity) == (None, (), (5.0, 0.0), (0.0, 0.0))

    def test_a_motion_tells_where_its_body_is_at_the_start(self, read):
        assert read(PLANE + MOTION.replace("[0.0, 0.1, 0.2]", "[-0.05, 0.05, 0.2]", 1)).body("sled").position == (5.5, 0.05)

    def test_orientations_of_a_motion_in_space_are_normalised(self, read):
        rows = "orientation = [[1.0, 0.0, 0.0, 0.0], [0.9950042, 0.0, 0.0, 0.0998334], [0.98, 0.0, 0.0, 0.1989975]]"
        motion = MOTION.replace("orientation = [0.0, 0.1, 0.2]", rows).replace("[5.0, 0.0]", "[5.0, 0.0, 0.0]")
        motion = motion.replace("[6.0, 0.1]", "[6.0, 0.1, 0.0]").replace("[7.0, 0.4]", "[7.0, 0.4, 0.0]")
        rows = read(SPACE + motion).body("sled").motion.orientation
        assert np.linalg.norm(rows, axis=1) == pytest.approx(1.0, abs=1e-15)

    def test_a_given_force(self, read):
        text = in_plane("angular_velocity = 0.2\n", f"angular_velocity = 0.2\n{FORCE}")
        assert read(text).body("car").force == GivenForce((0.0, 0.1), ((0.0, 10.0), (0.0, 0.0)), ((3.0,), (0.0,)))


def test_is_written_as_a_person_would(read, laws):
    text = in_plane("angular_velocity = 0.2\n", f"angular_velocity = 0.2\n{FORCE}") + MOTION
    written = model_to_toml(read(text), laws)
    assert written.startswith(
        'schema = "crashkit-model/1"\nname = "car and barrier"\naxes = ["x", "y"]\ngravity = [0.0, -9.81]\n\n'
    )
    assert (
        "mass = 1000.0\ninertia = 1500.0\nposition = [-2.0, 0.0]\norientation = 0.1\nvelocity = [15.0, 0.0]\n"
        "angular_velocity = 0.2\n"
        "[body.force]\ntime = [0.0, 0.1]\nforce = [\n    [0.0, 10.0],\n    [0.0, 0.0],\n]\nmoment = [3.0, 0.0]\n\n"
    ) in written
    assert (
        '[[body]]\nname = "sled"\nposition = [5.0, 0.0]\n'
        "[body.motion]\ntime = [0.0, 0.1, 0.2]\nposition = [\n    [5.0, 0.0],\n    [6.0, 0.1],\n    [7.0, 0.4],\n]\n"
        "orientation = [0.0, 0.1, 0.2]\n\n"
    ) in written
    assert "points = [[0.0, 0.0], [2.0, 0.5]]\nnormal = [-1.0, 0.0]\nlaw" in written
    assert read(written) == read(text)


class TestFaultsInThePlane:
    @pytest.mark.parametrize(
        ("old", "new", "expected"),
        [
            ("gravity = [0.0, -9.81]", "gravity = [-9.81]", "gravity: expected one number for each of 2 axes, found 1 number"),
            ("gravity = [0.0, -9.81]", "gravity = 9.81", "gravity: expected a list of numbers, found 9.81"),
            ("inertia = 1500.0\n", "", 'body "car"/inertia: expected a moment of inertia in kg m2, found none'),
            (
                "inertia = 1500.0",
                "inertia = [1.0, 2.0]",
                'body "car"/inertia: expected a moment of inertia in kg m2, found 2 numbers',
            ),
            ("inertia = 1500.0", "inertia = 0.0", 'body "car"/inertia: expected a moment of inertia above 0, found 0.0'),
            (
                "inertia = 1500.0",
                'inertia = "big"',
                'body "car"/inertia: expected a number, or a table of "value", "lower", "upper", "fixed", found "big"',
            ),
            (
                "inertia = 1500.0",
                "inertia = { value = 5, upper = 4 }",
                'body "car"/inertia: expected a value from 0.0 to 4.0, found 5.0',
            ),
            (
                "orientation = 0.1",
                "orientation = [1.0, 0.0, 0.0, 0.0]",
                'body "car"/orientation: expected an angle in rad, found 4 numbers',
            ),
            ("orientation = 0.1", "orientation = nan", 'body "car"/orientation: expected finite numbers, found nan'),
            (
                "orientation = 0.1",
                'orientation = "left"',
                'body "car"/orientation: expected a number or a list of numbers, found "left"',
            ),
            (
                "angular_velocity = 0.2",
                "angular_velocity = [0.0, 0.0, 0.2]",
                'body "car"/angular_velocity: expected one number in rad s-1, found 3 numbers',
            ),
            (
                "fixed = true",
                "fixed = true\nangular_velocity = 0.2",
                'body "barrier"/angular_velocity: expected no angular velocity for a fixed body, found 0.2',
            ),
            (
                "normal = [-1.0, 0.0]",
                "normal = [-1.0, 0.5]",
                'joint "front"/normal: expected a vector of length 1, found one of length 1.11803399',
            ),
            (
                "normal = [-1.0, 0.0]",
                "normal = [-1.0]",
                'joint "front"/normal: expected one number for each of 2 axes, found 1 number',
            ),
            ("normal = [-1.0, 0.0]", "normal = 1.0", 'joint "front"/normal: expected a list of numbers, found 1.0'),
            (
                "points = [[0.0, 0.0], [2.0, 0.5]]",
                "points = [[0.0, 0.0], [2.0]]",
                'joint "front"/points: expected one number for each of 2 axes, found 1 number',
            ),
        ],
    )
    def test_each_is_one_line(self, faults, old, new, expected):
        assert faults(in_plane(old, new)) == [expected]

    @pytest.mark.parametrize(
        ("old", "new", "expected"),
        [
            ("time = [0.0, 0.1, 0.2]\n", "", 'body "sled"/motion/time: expected a list of numbers, found none'),
            (
                "time = [0.0, 0.1, 0.2]",
                "time = [0.0, 0.2, 0.1]",
                'body "sled"/motion/time: expected strictly increasing numbers, found 0.1 after 0.2',
            ),
            (
                "[[5.0, 0.0], [6.0, 0.1], [7.0, 0.4]]",
                "[[5.0, 0.0], [6.0, 0.1]]",
                'body "sled"/motion/position: expected one row for each of 3 times, found 2 rows',
            ),
            (
                "[[5.0, 0.0], [6.0, 0.1], [7.0, 0.4]]",
                "[[5.0, 0.0], [6.0], [7.0]]",
                'body "sled"/motion/position[1]: expected a row of 2 numbers, found 1 number',
            ),
            (
                "[7.0, 0.4]",
                "[7.0, inf]",
                'body "sled"/motion/position[2]: expected finite numbers, found inf',
            ),
            (
                "[[5.0, 0.0], [6.0, 0.1], [7.0, 0.4]]",
                '"straight on"',
                'body "sled"/motion/position: expected a list of numbers, or of lists of numbers, found "straight on"',
            ),
            (
                "orientation = [0.0, 0.1, 0.2]",
                "orientation = [0.0, [0.1, 0.0], 0.2]",
                'body "sled"/motion/orientation[1]: expected a row of 1 number, found 2 numbers',
            ),
            (
                "orientation = [0.0, 0.1, 0.2]",
                "yaw = [0.0, 0.1, 0.2]",
                'body "sled"/motion: expected one of the keys ("time", "position", "orientation"), found "yaw"',
            ),
            (
                'name = "sled"',
                'name = "sled"\norientation = 0.3',
                'body "sled"/orientation: expected none beside those of the given motion, found 0.3',
            ),
            (
                'name = "sled"',
                'name = "sled"\nvelocity = [1.0, 0.0]',
                'body "sled"/velocity: expected no velocity for a body whose motion is given, found 1.0, 0.0',
            ),
            (
                'name = "sled"',
                'name = "sled"\nangular_velocity = 1.0',
                'body "sled"/angular_velocity: expected no angular velocity for a body whose motion is given, found 1.0',
            ),
            (
                'name = "sled"',
                'name = "sled"\nfixed = true',
                'body "sled"/motion: expected no motion for a fixed body, found one',
            ),
            (
                "[body.motion]",
                "[body.force]\ntime = [0.0, 0.1]\nforce = [[0.0, 0.0], [0.0, 0.0]]\n[body.motion]",
                'body "sled"/force: expected no force for a body whose motion is given, found one',
            ),
        ],
    )
    def test_of_a_given_motion(self, faults, old, new, expected):
        assert old in MOTION
        assert faults(PLANE + MOTION.replace(old, new)) == [expected]

    def test_a_motion_of_one_sample(self, faults):
        motion = '[[body]]\nname = "sled"\n[body.motion]\ntime = [0.0]\nposition = [[5.0, 0.0]]\n'
        assert faults(PLANE + motion) == ['body "sled"/motion/time: expected at least two times, found 1 number']

    @pytest.mark.parametrize(
        ("old", "new", "expected"),
        [
            (
                "force = [[0.0, 10.0], [0.0, 0.0]]\n",
                "",
                'body "car"/force/force: expected a list of numbers, or of lists of numbers, found none',
            ),
            (
                "[[0.0, 10.0], [0.0, 0.0]]",
                "[0.0, 10.0]",
                'body "car"/force/force[0]: expected a row of 2 numbers, found 1 number',
            ),
            (
                "moment = [3.0, 0.0]",
                "moment = [3.0]",
                'body "car"/force/moment: expected one row for each of 2 times, found 1 rows',
            ),
            (
                "moment = [3.0, 0.0]",
                "moment = [[3.0, 0.0, 0.0], [0.0, 0.0, 0.0]]",
                'body "car"/force/moment[0]: expected a row of 1 number, found 3 numbers',
            ),
        ],
    )
    def test_of_a_given_force(self, faults, old, new, expected):
        text = in_plane("angular_velocity = 0.2\n", f"angular_velocity = 0.2\n{FORCE}")
        assert old in text
        assert expected in faults(text.replace(old, new))

    def test_only_given_motions(self, faults):
        assert faults(f"{PLANE.split('[[body]]')[0]}{MOTION}") == [
            "body: expected at least one body that forces move, found none"
        ]


class TestFaultsInSpace:
    @pytest.mark.parametrize(
        ("old", "new", "expected"),
        [
            (
                "inertia = [400.0, 1400.0, 1500.0]\n",
                "",
                'body "car"/inertia: expected three moments of inertia in kg m2 (principal), six (Ixx, Iyy, Izz, Ixy, Ixz, '
                "Iyz), or a number about every axis, found none",
            ),
            (
                "inertia = [400.0, 1400.0, 1500.0]",
                "inertia = {value = 1500.0, fixed = false}",
                'body "car"/inertia: expected three moments of inertia in kg m2 (principal), six (Ixx, Iyy, Izz, Ixy, Ixz, '
                "Iyz), or a number about every axis, found 1 number",
            ),
            (
                "[400.0, 1400.0, 1500.0]",
                "[400.0, 1400.0, 1900.0]",
                'body "car"/inertia: expected principal moments of which none exceeds the sum of the others, found principal '
                "moments 400, 1400, 1900",
            ),
            (
                "[400.0, 1400.0, 1500.0]",
                "[400.0, 1400.0, 1500.0, 800.0, 0.0, 0.0]",
                'body "car"/inertia: expected a positive definite matrix, found principal moments -43.3981, 1500, 1843.4',
            ),
            (
                "[400.0, 1400.0, 1500.0]",
                "[-400.0, 1400.0, 1500.0]",
                'body "car"/inertia[0]: expected a moment of inertia above 0, found -400.0',
            ),
            (
                "[400.0, 1400.0, 1500.0]",
                "[400.0, 1400.0, 1500.0, nan, 0.0, 0.0]",
                'body "car"/inertia[3]: expected a finite number, found nan',
            ),
            (
                "orientation = [0.6, 0.0, 0.0, 0.8]",
                "orientation = 0.3",
                'body "car"/orientation: expected a quaternion (w, x, y, z), found 1 number',
            ),
            (
                "orientation = [0.6, 0.0, 0.0, 0.8]",
                "orientation = [0.6, 0.0, 0.0, 0.9]",
                'body "car"/orientation: expected a quaternion of length 1, found one of length 1.08166538',
            ),
            (
                "angular_velocity = [0.0, 0.0, 0.2]",
                "angular_velocity = 0.2",
                'body "car"/angular_velocity: expected three numbers in rad s-1, found 1 number',
            ),
        ],
    )
    def test_each_is_one_line(self, faults, old, new, expected):
        assert faults(in_space(old, new)) == [expected]

    def test_a_thin_plate_is_no_fault(self, read):
        read(in_space("[400.0, 1400.0, 1500.0]", "[0.1, 0.2, 0.3]"))

    def test_a_given_orientation_that_is_no_unit_quaternion(self, faults):
        motion = '[[body]]\nname = "sled"\n[body.motion]\ntime = [0.0, 1.0]\nposition = [[5, 0, 0], [6, 0, 0]]\n'
        rows = "orientation = [[1, 0, 0, 0], [1, 0, 0, 1]]\n"
        assert faults(SPACE + motion + rows) == [
            'body "sled"/motion/orientation[1]: expected a quaternion of length 1, found one of length 1.41421356'
        ]


class TestFaultsInOneAxis:
    @pytest.mark.parametrize(
        ("old", "new", "expected"),
        [
            ("mass = 280", "mass = 280\ninertia = 5.0", 'body "engine"/inertia: expected none in one axis, found 5.0'),
            ("mass = 280", "mass = 280\norientation = 0.0", 'body "engine"/orientation: expected none in one axis, found 0.0'),
            (
                "mass = 280",
                "mass = 280\nangular_velocity = 0.1",
                'body "engine"/angular_velocity: expected none in one axis, found 0.1',
            ),
            ('law = "linear"', 'normal = [1.0]\nlaw = "linear"', 'joint "front"/normal: expected none in one axis, found 1.0'),
            (
                "velocity = [15.6]",
                "[body.force]\ntime = [0.0, 1.0]\nforce = [0.0, 1.0]\nmoment = [0.0, 1.0]",
                'body "engine"/force/moment: expected none in one axis, found 2 rows',
            ),
            (
                "mass = 280\nposition = [-0.55]\nvelocity = [15.6]",
                "[body.motion]\ntime = [0.0, 1.0]\nposition = [0.0, 1.0]\norientation = [0.0, 1.0]",
                'body "engine"/motion/orientation: expected none in one axis, found 2 rows',
            ),
        ],
    )
    def test_what_turns_is_refused(self, faults, text, old, new, expected):
        assert old in text
        assert expected in faults(text.replace(old, new))


class TestSingularGeometry:
    """The line between two attachments has no direction where they meet."""

    def test_in_the_plane(self, faults):
        text = in_plane("normal = [-1.0, 0.0]\n", "").replace("[[0.0, 0.0], [2.0, 0.5]]", "[[-2.0, 0.0], [0.0, 0.0]]")
        assert faults(text.replace("orientation = 0.5\n", "")) == [
            'joint "front"/points: expected attachments apart at t = 0, or a normal (the line between them has no direction), '
            "found both in one place"
        ]

    def test_bodies_turn_their_points(self, read, faults):
        text = in_plane("normal = [-1.0, 0.0]\n", "").replace("[[0.0, 0.0], [2.0, 0.5]]", "[[-2.0, 0.0], [0.0, 0.0]]")
        read(text)
        text = text.replace("orientation = 0.5", f"orientation = {math.pi / 2}").replace(
            "position = [-2.0, 0.0]", "position = [0, -2]"
        )
        assert len(faults(text)) == 1

    def test_in_space(self, read, faults):
        text = in_space("normal = [-1.0, 0.0, 0.0]\n", "").replace("[1.0, 0.0, 0.0, 0.0]", "[0.5, 0.5, 0.5, 0.5]")
        text = text.replace("[[0.0, 0.0, 0.0], [2.0, 0.5, 0.0]]", "[[0.0, 0.0, -2.0], [0.0, 0.0, 0.0]]")
        assert faults(text) == [
            'joint "front"/points: expected attachments apart at t = 0, or a normal (the line between them has no direction), '
            "found both in one place"
        ]
        read(text.replace("[0.0, 0.0, -2.0]", "[0.0, 0.0, -1.9]"))

    def test_centres_of_mass(self, faults):
        text = in_plane("normal = [-1.0, 0.0]\n", "").replace("points = [[0.0, 0.0], [2.0, 0.5]]\n", "")
        assert len(faults(text.replace("position = [-2.0, 0.0]", "position = [0.0, 0.0]"))) == 1

    def test_is_no_fault_of_a_face_nor_in_one_axis(self, read, text):
        read(in_plane("position = [-2.0, 0.0]", "position = [0.0, 0.0]").replace("[2.0, 0.5]", "[0.0, 0.0]"))
        read(text.replace("position = [-0.55]", "position = [0.0]"))
