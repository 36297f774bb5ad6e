"""Time and memory against the number of bodies (1 to 200), of joints and of parameters.

Chains of bodies that run into a wall, in one axis and in the plane; one body with more and more joints; a chain of 20 bodies
with derivatives to more and more parameters. An exponent is the slope of a straight line through the logarithms of the
larger half: 1 is linear. Memory is the most that numpy's arrays took at once.
"""

import tracemalloc
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from benchmarks import Row
from benchmarks._mechanics.models import LAWS
from benchmarks._mechanics.timing import fastest
from crashkit.mechanics import Engine, Simulator
from crashkit.model import Body, Joint, Model, Parameter

BODIES = (1, 2, 5, 10, 20, 50, 100, 200)
JOINTS = (1, 2, 5, 10, 20, 50, 100, 200)
PARAMETERS = (1, 2, 5, 10, 20, 50)
STEP, TIMES = 1e-4, np.linspace(0.0, 0.02, 21)
CRUSH = {
    "elastic_stiffness": 1e6,
    "crush_force": 5e4,
    "densification_deformation": 0.15,
    "densification_stiffness": 5e5,
    "unloading_stiffness": 3e6,
    "rate_coefficient": 0.01,
}


def run() -> list[Row]:
    """Each size, and the exponents."""
    engines: dict[int, Engine] = {}

    def simulator(model: Model) -> Simulator:
        made = Simulator(model, LAWS, engines.get(len(model.axes)))
        engines[len(model.axes)] = made.engine
        return made

    rows: list[Row] = []
    for axes in (1, 2):
        where = "one axis" if axes == 1 else "plane"
        rows += _series(f"{where}, bodies", BODIES, lambda n, axes=axes: _call(simulator(chain(n, axes))))
        rows += _series(f"{where}, joints", JOINTS, lambda n, axes=axes: _call(simulator(chain(1, axes, n))))
        whole = simulator(chain(20, axes))
        paths = [path for path in whole.model.parameters() if path.endswith(("crush_force", "elastic_stiffness", "mass"))]
        rows += _series(f"{where}, parameters", PARAMETERS, lambda n, s=whole, p=paths: _call(s, p[:n]))
    return rows


def chain(count: int, axes: int, joints: int = 1) -> Model:
    """Bodies in a row against a wall, so many joints side by side between each and the next."""
    zero = (0.0,) * axes
    inertia = (Parameter(30.0),) if axes == 2 else ()
    bodies = [Body("wall", zero, zero, fixed=True)]
    for i in range(count):
        place, speed = (-1.0 - i, *zero[1:]), (12.0, *zero[1:])
        bodies.append(Body(f"b{i}", place, speed, Parameter(100.0), inertia=inertia))
    pairs = zip(bodies[:-1], bodies[1:], strict=True)
    made = [_joint(f"{second.name}_{k}", (first.name, second.name), axes, k) for first, second in pairs for k in range(joints)]
    return Model("chain", ("x", "y")[:axes], tuple(bodies), tuple(made))


def _joint(name: str, bodies: tuple[str, str], axes: int, number: int) -> Joint:
    """With a little of its own each, so that corners are not met together."""
    aside = 0.01 * number
    points = ((0.0, aside), (0.0, aside)) if axes == 2 else None
    values = {key: Parameter(value * (1.0 + 1e-3 * number)) for key, value in CRUSH.items()}
    return Joint(name, bodies, "crush_plateau", values, points=points)


def _call(simulator: Simulator, paths: Sequence[str] = ()) -> Callable[[], object]:
    return lambda: simulator.record(TIMES, sensitivities=paths, step=STEP)


def _series(name: str, sizes: Sequence[int], call: Callable[[int], Callable[[], object]]) -> Iterator[Row]:
    calls = {str(n): call(n) for n in sizes}
    spent = fastest(calls, budget=1.0)
    times, memory = [1e3 * (spent[str(n)] or np.nan) for n in sizes], [_memory(calls[str(n)]) for n in sizes]
    for n, time, peak in zip(sizes, times, memory, strict=True):
        yield Row(f"{name}: {n}", "time", "ms", time, "", None)
        yield Row(f"{name}: {n}", "memory", "kB", peak, "", None)
    yield Row(f"{name}: exponent", "time", "1", _exponent(sizes, times), "linear", 1.0)
    yield Row(f"{name}: exponent", "memory", "1", _exponent(sizes, memory), "linear", 1.0)


def _memory(call: Callable[[], object]) -> float:
    tracemalloc.start()
    try:
        call()
        return tracemalloc.get_traced_memory()[1] / 1e3
    finally:
        tracemalloc.stop()


def _exponent(sizes: Sequence[int], values: Sequence[float]) -> float:
    half = len(sizes) // 2
    return float(np.polyfit(np.log(sizes[half:]), np.log(values[half:]), 1)[0])
