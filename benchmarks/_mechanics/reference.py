"""The reference in C, compiled for one model with `cc -O3 -march=native`."""

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np
from attrs import frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit_spring_laws import CrushPlateau

SOURCES = Path(__file__).parents[1] / "reference"
FLAGS = ("-O3", "-march=native", "-fopenmp-simd", "-std=gnu11", "-shared", "-fPIC")
LANES = 4
"""To a multiple of which columns are filled up, so that every one of them is in a vector."""
NAMES = [spec.name for spec in CrushPlateau.parameters if spec.name not in ("toe", "tension_force")]
"""The C reference engages at once, and pulls as hard as the law says."""

Floats = np.ndarray


def compiler() -> str | None:
    """The C compiler, if there is one."""
    return shutil.which("cc")


@frozen
class Motion:
    """What the reference records of the bodies that move; derivatives have a last axis of parameters.

    Arguments:
        position, velocity, acceleration: (time, coordinate), in plane motion with the angles.
        force: (time, joint) N.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    force: Floats


class Reference:
    """One model in C.

    Arguments:
        model: in one axis or in the plane, of fixed and free bodies, with no law but `crush_plateau`.
        paths: parameters to differentiate to: of laws, masses, inertia, velocities, free lengths.
        extended: whether to compute in the processor's extended precision, of 64 bits instead of 53.
    """

    def __init__(self, model: Model, paths: Sequence[str] = (), extended: bool = False) -> None:
        self.model = model
        self.real = np.longdouble if extended else np.float64
        self.paths = tuple(paths)
        self.bodies = sorted(model.bodies, key=lambda body: body.fixed)
        self.dof = 1 if len(model.axes) == 1 else 3
        self.moving = sum(not body.fixed for body in self.bodies)
        self.columns = -(-len(self.paths) // LANES) * LANES
        self.input = np.zeros((), self._layout())
        self.seeds = np.zeros((), self._layout((self.columns,)))
        self._fill()
        for column, path in enumerate(self.paths):
            self._seed(column, path)
        self.compiled = _built(self._definitions())
        self._number = ctypes.c_longdouble if extended else ctypes.c_double

    def run(self, times: Floats, step: float, plain: bool = False) -> tuple[Motion, Motion]:
        """The motion and its derivatives."""
        values, tangents = self.room(times.size)
        self.call(times.astype(self.real), step, plain, values, tangents)
        return self._motion(values), self._motion(tangents[..., : len(self.paths)])

    def room(self, times: int) -> tuple[Floats, Floats]:
        """Arrays for the results of `call`."""
        width = 3 * self.dof * self.moving + len(self.model.joints)
        return np.empty((times, width), self.real), np.empty((times, width, self.columns), self.real)

    def call(self, times: Floats, step: float, plain: bool, values: Floats, tangents: Floats) -> tuple[int, int]:
        """The C function and nothing else; returns how many steps it took, and how many it tried."""
        trials = ctypes.c_long()
        steps = self.compiled.integrate(
            *map(_pointer, (self.input, self.seeds)),
            int(plain),
            _pointer(times),
            ctypes.c_long(times.size),
            self._number(step),
            *map(_pointer, (values, tangents)),
            ctypes.byref(trials),
        )
        if steps < 0:
            raise RuntimeError(f"model {self.model.name}: the reference in C does not get on")
        return steps, trials.value

    def inputs(self, values: Mapping[str, Floats]) -> Floats:
        """Inputs of many runs, with values by path."""
        out = np.repeat(self.input[None], len(next(iter(values.values()))))
        for path, column in values.items():
            name, indices, inverse = self._place(path)
            for index in indices:
                out[name][:, *index] = 1.0 / column if inverse else column
        return out

    def call_many(self, inputs: Floats, end: float, step: float, plain: bool, values: Floats) -> int:
        """Many runs to `end`, the state of each there to `values`; returns how many steps."""
        steps: int = self.compiled.integrate_many(
            _pointer(inputs),
            ctypes.c_long(inputs.size),
            _pointer(self.seeds),
            int(plain),
            self._number(end),
            self._number(step),
            _pointer(values),
        )
        return steps

    def _motion(self, values: Floats) -> Motion:
        n = self.dof * self.moving
        return Motion(*np.split(values, [n, 2 * n, 3 * n], axis=1))

    def _definitions(self) -> tuple[str, ...]:
        joints = self.model.joints
        ends = [[self.body(name) for name in joint.bodies] for joint in joints]
        lists = {
            "FIRST": [first for first, _ in ends],
            "SECOND": [second for _, second in ends],
            "FACE": [int(joint.normal is not None) for joint in joints],
        }
        sizes = {
            "AXES": len(self.model.axes),
            "MOVING": self.moving,
            "FIXED": len(self.bodies) - self.moving,
            "JOINTS": len(joints),
            "COLUMNS": self.columns,
        }
        texts = {name: "{" + ",".join(map(str, values)) + "}" for name, values in lists.items()}
        extended = ("-DEXTENDED",) if self.real is np.longdouble else ()
        return (*extended, *(f"-D{name}={value}" for name, value in {**sizes, **texts}.items()))

    def _layout(self, last: tuple[int, ...] = ()) -> np.dtype:
        """The C structures `Model` and, with a last axis of columns, `Seeds`."""
        joints, n = len(self.model.joints), self.dof * self.moving
        shapes = {
            "inverse_mass": (n, *last),
            "start": (2, self.dof * len(self.bodies), *last),
            "p": (joints, len(NAMES), *last),
            **({} if last else {"places": (joints, 6)}),
            "rest": (joints, *last),
        }
        return np.dtype([(name, self.real, shape) for name, shape in shapes.items()])

    def _fill(self) -> None:
        axes = len(self.model.axes)
        for i, body in enumerate(self.bodies):
            own = slice(self.dof * i, self.dof * (i + 1))
            self.input["start"][0, own] = [*body.position, *(body.orientation or (0.0,))][: self.dof]
            if not body.fixed:
                self.input["start"][1, own] = [*body.velocity, *(body.angular_velocity or (0.0,))][: self.dof]
                self.input["inverse_mass"][own] = 1.0 / _masses(body, self.dof)
        for j, joint in enumerate(self.model.joints):
            self.input["p"][j] = [_value(joint, name) for name in NAMES]
            places, distance = self._geometry(joint, axes)
            self.input["places"][j] = places
            self.input["rest"][j] = joint.free_length.value if joint.free_length else distance

    def _geometry(self, joint: Joint, axes: int) -> tuple[Floats, float]:
        """The places of a joint as C wants them, and the distance of its ends at t = 0."""
        places = np.zeros((3, 2))
        places[:2, :axes] = joint.points or ((0.0,) * axes,) * 2
        starts = [self.input["start"][0, self.dof * self.body(name) :][: self.dof] for name in joint.bodies]
        if axes == 1:
            apart = starts[1][0] + places[1, 0] - starts[0][0] - places[0, 0]
            places[2, 0] = -1.0 if apart < 0.0 else 1.0
            return places.ravel(), abs(apart)
        frames = [np.array([[np.cos(q[2]), -np.sin(q[2])], [np.sin(q[2]), np.cos(q[2])]]) for q in starts]
        apart = starts[1][:2] + frames[1] @ places[1] - starts[0][:2] - frames[0] @ places[0]
        if joint.normal is None:
            return places.ravel(), float(np.hypot(*apart))
        places[2] = joint.normal
        return places.ravel(), float(frames[0] @ places[2] @ apart)

    def value(self, path: str) -> float:
        """A parameter's value."""
        name, index, inverse = self._place(path)
        found = self.input[name][index[0]]
        return 1.0 / found if inverse else found

    def put(self, path: str, value: float) -> None:
        """Give a parameter another value."""
        name, indices, inverse = self._place(path)
        for index in indices:
            self.input[name][index] = 1.0 / value if inverse else value

    def _seed(self, column: int, path: str) -> None:
        """Make a column the derivatives to one parameter."""
        name, indices, inverse = self._place(path)
        for index in indices:
            self.seeds[name][*index, column] = -(self.input[name][index] ** 2) if inverse else 1.0

    def _place(self, path: str) -> tuple[str, list[tuple[int, ...]], bool]:
        """The field of `input`, the indices in it, and whether it holds the inverse."""
        kind, name, what = path.split(".")
        what, _, index = what.rstrip("]").partition("[")
        if kind == "joint":
            joint = self._joint(name)
            return ("rest", [(joint,)], False) if what == "free_length" else ("p", [(joint, NAMES.index(what))], False)
        first = self.dof * self.body(name)
        if what == "velocity":
            return "start", [(1, first + int(index or 0))], False
        coordinates = {"mass": range(min(self.dof, 2)), "inertia": [2]}[what]
        return "inverse_mass", [(first + i,) for i in coordinates], True

    def body(self, name: str) -> int:
        """Its place among the bodies, those that move first."""
        return [body.name for body in self.bodies].index(name)

    def _joint(self, name: str) -> int:
        return [joint.name for joint in self.model.joints].index(name)


@cache
def _built(definitions: tuple[str, ...]) -> ctypes.CDLL:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "reference.so"
        command = ["cc", *FLAGS, *definitions, str(SOURCES / "reference.c"), "-o", str(path), "-lm"]
        subprocess.run(command, check=True, capture_output=True)
        library = ctypes.CDLL(str(path))
    library.integrate.restype = library.integrate_many.restype = ctypes.c_long
    return library


def _pointer(array: Floats) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _masses(body: Body, dof: int) -> Floats:
    assert body.mass is not None
    return np.array([body.mass.value] * min(dof, 2) + [inertia.value for inertia in body.inertia][: dof - 1])


def _value(joint: Joint, name: str) -> float:
    value = joint.parameters.get(name, Parameter(0.0))
    assert isinstance(value, Parameter)
    return value.value
