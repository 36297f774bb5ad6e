"""Where markers fixed on bodies are at the time stamps of an instrument, and what its own errors make of that."""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, SensorErrors


def error_values(observer: Observer, markers: Sequence[str], errors: SensorErrors | None) -> dict[str, np.ndarray]:
    """Every error parameter of the observer as one value for each marker.

    Markers that `errors` names and the film does not have are passed over: a run may lack a marker that others have.

    Raises CrashkitError for a parameter that is not declared, or not of a single marker.
    """
    values = {spec.name: np.full(len(markers), spec.null) for spec in observer.errors}
    for marker, given in (errors or {}).items():
        known = set(values) if marker == "" else set(values) - set(observer.instrument_errors)
        rows = [row for row, name in enumerate(markers) if marker in ("", name)]
        for name, value in given.items():
            if name not in known:
                raise CrashkitError(f"{observer.name} {marker!r}: expected an error of {sorted(known)}, found {name!r}")
            values[name][rows] = value
    return values


def selection(motion: xr.Dataset, instrument: xr.Dataset) -> Callable[[str], np.ndarray]:
    """Picks, of a motion's variable, each marker's body and axes: (time, body, axis, ...) to (time, marker, axis, ...)."""
    bodies = _rows(motion, "body", instrument.variables["marker_body"].values)
    axes = _rows(motion, "axis", instrument.variables["axis"].values)

    def select(name: str) -> np.ndarray:
        if name not in motion.variables:
            raise CrashkitError(f"film: expected a motion with {name}, found none")
        return motion.variables[name].values.take(bodies, axis=1).take(axes, axis=2)

    return select


def sample_path(
    nodes: np.ndarray, position: np.ndarray, velocity: np.ndarray, at: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity at the times `at` by cubic Hermite interpolation, exact at the nodes.

    Motion before the first node is uniform if that node is not after the first contact, at t = 0; NaN after the last node.

    Arguments:
        nodes: s, (node,).
        position, velocity: (node, ...), or their derivatives to parameters.
        at: s, (time,).

    Returns:
        Position and its rate, (time, ...).
    """
    index = np.searchsorted(nodes, at, side="right").clip(1, len(nodes) - 1)
    column = (-1,) + (1,) * (position.ndim - 1)
    h = (nodes[index] - nodes[index - 1]).reshape(column)
    s = (at - nodes[index - 1]).reshape(column) / h
    start, start_rate = position.take(index - 1, axis=0), velocity.take(index - 1, axis=0)
    step, end_rate = position.take(index, axis=0) - start, velocity.take(index, axis=0)
    square = 3.0 * step / h - 2.0 * start_rate - end_rate
    cube = start_rate + end_rate - 2.0 * step / h
    value = start + h * s * (start_rate + s * (square + s * cube))
    rate = start_rate + s * (2.0 * square + 3.0 * s * cube)

    before = at < nodes[0]
    value[before] = position[0] + velocity[0] * (at[before] - nodes[0]).reshape(column)
    rate[before] = velocity[0]
    unknown = (at > nodes[-1]) | (before & (nodes[0] > 0.0))
    value[unknown] = np.nan
    rate[unknown] = np.nan
    return value, rate


def _rows(motion: xr.Dataset, dim: str, names: np.ndarray) -> list[int]:
    known = motion.variables[dim].values.tolist()
    missing = set(names.tolist()) - set(known)
    if missing:
        raise CrashkitError(f"film: expected a {dim} of the motion ({', '.join(known)}), found {', '.join(sorted(missing))}")
    return [known.index(name) for name in names.tolist()]
