"""Where markers fixed on bodies are at the time stamps of an instrument."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from attrs import frozen
from numba import njit

from crashkit.data.instrument_errors import positions
from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, Shown
from crashkit_cameras.turning import turning, turning_slopes

AXES = ("x", "y", "z")
SLOPES = tuple(f"{name}_sensitivity" for name in ("position", "velocity", "rotation", "angular_velocity"))


@frozen(eq=False)
class MarkerMotion:
    """Positions of markers and their rates (time, marker, axis), and both at the motion's start (marker, axis).

    Those with `slope` are derivatives to the motion's parameters, with a last dim for these; None where it has none.
    """

    position: np.ndarray
    velocity: np.ndarray
    start: np.ndarray
    start_velocity: np.ndarray
    slope: np.ndarray | None
    start_slope: np.ndarray | None
    start_velocity_slope: np.ndarray | None


@frozen(eq=False)
class _Nodes:
    """The motion of markers at some of its instants, (node, marker, axis), and the derivatives of that, if there are any."""

    position: np.ndarray
    velocity: np.ndarray
    slope: np.ndarray | None
    velocity_slope: np.ndarray | None


def marker_motion(
    observer: Observer,
    motion: xr.Dataset,
    bodies: Sequence[str],
    points: np.ndarray,
    axes: Sequence[str],
    at: np.ndarray,
    in_space: bool = False,
) -> MarkerMotion:
    """The motion of markers, by cubic Hermite interpolation from their positions and velocities, exact at the motion's nodes.

    x + R p for a body that turns, x + p for one that does not. Motion before the first node is uniform if that node is not
    after the first contact, at t = 0; NaN after the last node.

    Arguments:
        observer: whose name messages begin with.
        motion: of the bodies; with `orientation` and `angular_velocity` if they turn, and with sensitivities or without.
        bodies: that carry the markers.
        points: of the markers in their bodies' frames, (marker, len(axes)), m.
        axes: of the laboratory frame that are wanted.
        at: s, (time,).
        in_space: whether along an axis that the motion lacks the bodies rest at 0; if not, it is asked for.
    """
    times = motion.variables["time"].values
    after = _next_node(times, at)
    rows, places = np.unique(np.concatenate([[0], after - 1, after]), return_inverse=True)
    moving = [axis for axis in axes if axis in motion.variables["axis"].values] if in_space else axes
    nodes = _nodes(observer, motion, rows, bodies, points, axes, moving)
    return _between(times[rows], nodes, places[len(at) + 1 :], at)


def shown_motion(shown: Shown, axes: int, at: np.ndarray) -> MarkerMotion:
    """The same from what an instrument shows of markers along so many axes."""

    def by_marker(columns: np.ndarray | None) -> np.ndarray | None:
        return None if columns is None else columns.reshape(len(columns), -1, axes, *columns.shape[2:])

    position, velocity = by_marker(shown.value), by_marker(shown.rate)
    assert position is not None and velocity is not None
    nodes = _Nodes(position, velocity, by_marker(shown.slope), by_marker(shown.rate_slope))
    return _between(shown.times, nodes, _next_node(shown.times, at), at)


def _next_node(times: np.ndarray, at: np.ndarray) -> np.ndarray:
    """The node that ends the interval in which, or next to which, each of the times `at` is."""
    return np.searchsorted(times, at, side="right").clip(1, len(times) - 1)


def _between(instants: np.ndarray, nodes: _Nodes, after: np.ndarray, at: np.ndarray) -> MarkerMotion:
    position, velocity = _interpolated(instants, nodes.position, nodes.velocity, after, at)
    if nodes.slope is None or nodes.velocity_slope is None:
        return MarkerMotion(position, velocity, nodes.position[0], nodes.velocity[0], None, None, None)
    slope, _ = _interpolated(instants, nodes.slope, nodes.velocity_slope, after, at)
    return MarkerMotion(
        position, velocity, nodes.position[0], nodes.velocity[0], slope, nodes.slope[0], nodes.velocity_slope[0]
    )


def _nodes(
    observer: Observer,
    motion: xr.Dataset,
    rows: np.ndarray,
    bodies: Sequence[str],
    points: np.ndarray,
    axes: Sequence[str],
    moving: Sequence[str],
) -> _Nodes:
    carriers = positions(observer, motion, "body", bodies)
    if "orientation" in motion.variables:
        return _turning_nodes(observer, motion, rows, carriers, points, axes)

    def along(name: str) -> np.ndarray:
        columns = positions(observer, motion, "axis", moving)
        values = _values(observer, motion, name).take(rows, axis=0).take(carriers, axis=1).take(columns, axis=2)
        if len(moving) == len(axes):
            return values
        full = np.zeros((*values.shape[:2], len(axes), *values.shape[3:]))
        full[:, :, [axis in moving for axis in axes]] = values
        return full

    slopes = SLOPES[:2] if SLOPES[0] in motion.variables else ()
    position, velocity, *slopes_along = map(along, ("position", "velocity", *slopes))
    return _Nodes(position + points, velocity, *(slopes_along or (None, None)))


def _turning_nodes(
    observer: Observer, motion: xr.Dataset, rows: np.ndarray, carriers: np.ndarray, points: np.ndarray, axes: Sequence[str]
) -> _Nodes:
    """Of markers on bodies that turn; their points lie on the axes that are wanted."""
    space = positions(observer, motion, "axis", AXES)

    def vector(name: str) -> np.ndarray:
        values = _values(observer, motion, name)
        return values if np.array_equal(space, np.arange(3)) else values.take(space, axis=2)

    wanted, full = np.array([AXES.index(axis) for axis in axes]), np.zeros((len(points), 3))
    full[:, wanted] = points
    spin, orientation = vector("angular_velocity"), _values(observer, motion, "orientation")
    place, speed, arms = turning(rows, carriers, full, wanted, vector("position"), vector("velocity"), orientation, spin)
    if SLOPES[0] not in motion.variables:
        return _Nodes(place, speed, None, None)
    return _Nodes(place, speed, *turning_slopes(rows, carriers, arms, wanted, spin, *map(vector, SLOPES)))


def _values(observer: Observer, motion: xr.Dataset, name: str) -> np.ndarray:
    if name not in motion.variables:
        raise CrashkitError(f"{observer.name}: expected a motion with {name}, found none")
    return np.ascontiguousarray(motion.variables[name].values)


def _interpolated(
    nodes: np.ndarray, position: np.ndarray, velocity: np.ndarray, after: np.ndarray, at: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Position and its rate at the times `at`, each before the node `after`, (time, ...)."""
    count, shape = len(nodes), (len(at), *position.shape[1:])
    value, rate = _hermite(nodes, position.reshape(count, -1), velocity.reshape(count, -1), after, at)
    return value.reshape(shape), rate.reshape(shape)


@njit(cache=True, error_model="numpy")
def _hermite(
    nodes: np.ndarray, position: np.ndarray, velocity: np.ndarray, after: np.ndarray, at: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """Of columns, (time, column). Plain loops: whole-array expressions would go through memory twenty times."""
    value = np.full((len(at), position.shape[1]), np.nan)
    rate = value.copy()
    for time in range(len(at)):
        if at[time] > nodes[-1] or (at[time] < nodes[0] and nodes[0] > 0.0):
            continue
        if at[time] < nodes[0]:
            value[time] = position[0] + velocity[0] * (at[time] - nodes[0])
            rate[time] = velocity[0]
            continue
        end = after[time]
        h = nodes[end] - nodes[end - 1]
        s = (at[time] - nodes[end - 1]) / h
        for column in range(position.shape[1]):
            start, start_rate, end_rate = position[end - 1, column], velocity[end - 1, column], velocity[end, column]
            step = position[end, column] - start
            square = 3.0 * step / h - 2.0 * start_rate - end_rate
            cube = start_rate + end_rate - 2.0 * step / h
            value[time, column] = start + h * s * (start_rate + s * (square + s * cube))
            rate[time, column] = start_rate + s * (2.0 * square + 3.0 * s * cube)
    return value, rate
