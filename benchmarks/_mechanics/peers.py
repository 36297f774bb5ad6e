"""The same models by general solvers, with the law as Python: scipy, and exudyn and MuJoCo where they are installed.

Each returns the positions of the bodies that move (coordinate) at the end, in plane motion with the angles.
"""

from collections.abc import Callable, Sequence
from importlib import import_module
from math import cos, hypot, sin
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks._mechanics.models import Case
from benchmarks._mechanics.reference import Reference
from crashkit_spring_laws import CrushPlateau

Numbers = Sequence[float]
Solver = Callable[[], np.ndarray]


def peers(case: Case) -> dict[str, Solver | None]:
    """What solves a case; None for a package that is not installed."""
    equations = Equations(Reference(case.model))
    solvers = {"exudyn": by_exudyn, "mujoco": by_mujoco}
    return {
        "scipy DOP853": lambda: by_scipy(equations, case),
        **{name: _of(name, solver, equations, case) for name, solver in solvers.items()},
    }


def _of(name: str, solver: Callable[..., np.ndarray], equations: "Equations", case: Case) -> Solver | None:
    try:
        package = import_module(name)
    except ImportError:
        return None
    return lambda: solver(package, equations, case)


class Equations:
    """A model's forces as a user of a general solver writes them: one law after another, in plain Python."""

    def __init__(self, reference: Reference) -> None:
        values = reference.input
        joints = reference.model.joints
        self.dof, self.size = reference.dof, reference.dof * reference.moving
        self.start = values["start"][0, : self.size].tolist(), values["start"][1, : self.size].tolist()
        self.mass = (1.0 / values["inverse_mass"]).tolist()
        self._fixed = values["start"][0, self.size :].tolist()
        self._joints = list(
            zip(
                [[reference.dof * reference.body(name) for name in joint.bodies] for joint in joints],
                [joint.normal is not None for joint in joints],
                values["places"].tolist(),
                values["rest"].tolist(),
                values["p"].tolist(),
                strict=True,
            )
        )

    @property
    def joints(self) -> int:
        """How many joints there are."""
        return len(self._joints)

    def net(self, q: Numbers, v: Numbers, d_max: Numbers) -> tuple[list[float], list[float], list[float]]:
        """Net forces and moments (coordinate), deformations and rates (joint)."""
        q, v = [*q, *self._fixed], [*v, *(0.0 for _ in self._fixed)]
        net, deformations, rates = [0.0] * len(q), [], []
        press = self._line if self.dof == 1 else self._plane
        for (a, b), face, place, rest, parameters, largest in zip(*zip(*self._joints, strict=True), d_max, strict=True):
            d, rate = press(net, a, b, face, place, rest, parameters, largest, q, v)
            deformations.append(d)
            rates.append(rate)
        return net[: self.size], deformations, rates

    def _line(self, net, a, b, face, place, rest, parameters, largest, q, v):  # type: ignore[no-untyped-def]
        side = place[4]
        d, rate = rest - side * (q[b] + place[2] - q[a] - place[0]), -side * (v[b] - v[a])
        force = side * CrushPlateau.force(d, rate, max(d, largest), *parameters, tension_force=np.inf, toe=0.0)
        net[a] -= force
        net[b] += force
        return d, rate

    def _plane(self, net, a, b, face, place, rest, parameters, largest, q, v):  # type: ignore[no-untyped-def]
        ca, sa, cb, sb = cos(q[a + 2]), sin(q[a + 2]), cos(q[b + 2]), sin(q[b + 2])
        ax, ay = ca * place[0] - sa * place[1], sa * place[0] + ca * place[1]
        bx, by = cb * place[2] - sb * place[3], sb * place[2] + cb * place[3]
        dx, dy = q[b] + bx - q[a] - ax, q[b + 1] + by - q[a + 1] - ay
        vx, vy = v[b] - v[b + 2] * by - v[a] + v[a + 2] * ay, v[b + 1] + v[b + 2] * bx - v[a + 1] - v[a + 2] * ax
        if face:
            nx, ny = ca * place[4] - sa * place[5], sa * place[4] + ca * place[5]
            length = nx * dx + ny * dy
            rate = -(nx * vx + ny * vy) - v[a + 2] * (nx * dy - ny * dx)
            ax, ay = ax + dx, ay + dy
        else:
            length = hypot(dx, dy)
            nx, ny = dx / length, dy / length
            rate = -(nx * vx + ny * vy)
        d = rest - length
        force = CrushPlateau.force(d, rate, max(d, largest), *parameters, tension_force=np.inf, toe=0.0)
        fx, fy = force * nx, force * ny
        for i, x, y, sign in ((a, ax, ay, -1.0), (b, bx, by, 1.0)):
            net[i] += sign * fx
            net[i + 1] += sign * fy
            net[i + 2] += sign * (x * fy - y * fx)
        return d, rate


def by_scipy(equations: Equations, case: Case) -> np.ndarray:
    """The largest deformations are states, which grow while they are exceeded; RK45 and LSODA stall on that in the plane."""
    n = equations.size

    def slope(_: float, state: np.ndarray) -> list[float]:
        q, v, d_max = np.split(state, [n, 2 * n])
        net, deformations, rates = equations.net(q.tolist(), v.tolist(), d_max.tolist())
        growing = [
            rate if d >= largest and rate > 0.0 else 0.0
            for d, rate, largest in zip(deformations, rates, d_max.tolist(), strict=True)
        ]
        return [*v, *(force / mass for force, mass in zip(net, equations.mass, strict=True)), *growing]

    start = [*equations.start[0], *equations.start[1], *([0.0] * equations.joints)]
    return solve_ivp(slope, (0.0, case.end), start, "DOP853", rtol=1e-6, atol=1e-8).y[:n, -1]


class _Memory:
    """The largest deformations at the ends of steps."""

    def __init__(self, equations: Equations) -> None:
        self.equations, self.d_max = equations, [0.0] * equations.joints

    def net(self, q: np.ndarray, v: np.ndarray) -> list[float]:
        return self.equations.net(q.tolist(), v.tolist(), self.d_max)[0]

    def remember(self, q: np.ndarray, v: np.ndarray) -> None:
        deformations = self.equations.net(q.tolist(), v.tolist(), self.d_max)[1]
        self.d_max = list(map(max, self.d_max, deformations))


def by_exudyn(exudyn: Any, equations: Equations, case: Case) -> np.ndarray:
    """Its explicit rule of fourth order, with forces from a user function."""
    items = import_module("exudyn.itemInterface")
    system = exudyn.SystemContainer().AddSystem()
    memory, n = _Memory(equations), equations.size
    q, v = equations.start
    node = system.AddNode(
        items.NodeGenericODE2(
            numberOfODE2Coordinates=n, referenceCoordinates=[0.0] * n, initialCoordinates=q, initialCoordinates_t=v
        )
    )

    def force(_: Any, t: float, item: int, q: Any, v: Any) -> list[float]:
        return memory.net(np.asarray(q), np.asarray(v))

    def before(own: Any, t: float) -> bool:
        memory.remember(own.systemData.GetODE2Coordinates(), own.systemData.GetODE2Coordinates_t())
        return True

    system.AddObject(items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(equations.mass), forceUserFunction=force))
    system.SetPreStepUserFunction(before)
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(case.end / case.step)
    settings.timeIntegration.endTime = case.end
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.displayGlobalTimers = False
    system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.RK44)
    return np.array(system.systemData.GetODE2Coordinates())


def by_mujoco(mujoco: Any, equations: Equations, case: Case) -> np.ndarray:
    """Its rule of fourth order, with slides and hinges to the world, and forces from a callback."""
    memory = _Memory(equations)
    model = mujoco.MjModel.from_xml_string(_mjcf(equations, case.step))
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = equations.start

    def force(_: Any, data: Any) -> None:
        data.qfrc_passive[:] = memory.net(data.qpos, data.qvel)

    mujoco.set_mjcb_passive(force)
    try:
        for _ in range(round(case.end / case.step)):
            memory.remember(data.qpos, data.qvel)
            mujoco.mj_step(model, data)
    finally:
        mujoco.set_mjcb_passive(None)
    return np.array(data.qpos)


def _mjcf(equations: Equations, step: float) -> str:
    axes = ["slide' axis='1 0 0", "slide' axis='0 1 0", "hinge' axis='0 0 1"][: equations.dof]
    joints = "".join(f"<joint type='{axis}'/>" for axis in axes)
    bodies = ""
    for i in range(0, equations.size, equations.dof):
        mass, inertia = equations.mass[i], f"{equations.mass[i + equations.dof - 1]!r} " * 3
        bodies += f"<body>{joints}<inertial pos='0 0 0' mass='{mass!r}' diaginertia='{inertia}'/></body>"
    return f"<mujoco><option timestep='{step!r}' integrator='RK4' gravity='0 0 0'/><worldbody>{bodies}</worldbody></mujoco>"
