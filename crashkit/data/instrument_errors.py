"""What every Observer's `predict` begins and ends with: error parameters by channel, places in a motion, coordinates."""

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError, did_you_mean
from crashkit.protocols import Observer, ParameterSpec, SensorErrors

ROCKING = (
    ParameterSpec(
        "rocking_share", "1", "how much of the reading is a turning of the body, which rocks", -2.0, 2.0, 0.0, null=0.0
    ),
    ParameterSpec("rocking_frequency", "s-1", "natural frequency of that", 0.1, 200.0, 10.0, null=10.0),
    ParameterSpec("rocking_damping", "1", "its damping, of critical", 1e-3, 0.99, 0.3, null=0.3),
)
"""Of a sensor on a body that turns about an axis which the model leaves out: u + share (ringing(u) - u), see `ringing`."""

CLOCK = (
    ParameterSpec("clock_offset", "s", "how late the time stamps are", -0.05, 0.05, default=0.0, null=0.0),
    ParameterSpec("clock_rate", "1", "how much later the time stamps get in every second", -0.05, 0.05, default=0.0, null=0.0),
)
"""Of a whole instrument, see `true_times`."""
CLOCK_ERRORS = tuple(spec.name for spec in CLOCK)


def true_times(stamps: np.ndarray, own: Mapping[str, np.ndarray]) -> np.ndarray:
    """When the samples of an instrument were taken: t (1 - clock_rate) - clock_offset, s.

    Arguments:
        stamps: t, (time,) s.
        own: error parameters of its channels, as `error_values` returns them.
    """
    return np.asarray(stamps * (1.0 - own["clock_rate"][0, 0]) - own["clock_offset"][0, 0])


def error_values(
    observer: Observer, channels: Sequence[str], axes: Sequence[str], errors: SensorErrors | None
) -> dict[str, np.ndarray]:
    """Every error parameter of an observer as one value for each channel and axis.

    `errors` names the whole instrument "", a channel "head", or one axis of it "head/x"; what is named more closely wins.
    Channels that the instrument does not have are passed over: a run may lack a sensor that others have.

    Arguments:
        observer: which declares `errors` and `instrument_errors`.
        channels: the labels of the instrument's dimension of channels.
        axes: the labels of the quantity's last dimension.
        errors: as given to `predict`.

    Returns:
        Arrays (channel, axis) by the name of the parameter.

    Raises CrashkitError for a parameter that is not declared, or not of a single channel.
    """
    block = _nulls(type(observer), len(channels), len(axes)).copy()
    values = {spec.name: own for spec, own in zip(observer.errors, block, strict=True)}
    for place, given in sorted((errors or {}).items(), key=lambda entry: (entry[0] != "", entry[0] not in channels)):
        here = _reached(place, tuple(channels), tuple(axes))
        for name, value in given.items():
            if name not in values or (place and name in observer.instrument_errors):
                known = set(values) if place == "" else set(values) - set(observer.instrument_errors)
                found = f"{name!r}{did_you_mean(name, known)}"
                raise CrashkitError(f"{observer.name} {place!r}: expected an error of {sorted(known)}, found {found}")
            values[name][here] = value
    return values


def coordinates(instrument: xr.Dataset, dims: Sequence[str]) -> list[np.ndarray]:
    """The time stamps or labels along these dims: of their indexes, which tell them ten times faster than the variables do."""
    indexes = instrument.xindexes
    return [np.asarray(indexes[dim].to_pandas_index() if dim in indexes else instrument.variables[dim]) for dim in dims]


def positions(observer: Observer, motion: xr.Dataset, dim: str, names: Sequence[str]) -> np.ndarray:
    """Where these bodies or axes are along `dim` of a motion; raises CrashkitError for one that it does not have."""
    known = motion.variables[dim].values.tolist()
    missing = sorted(set(names) - set(known))
    if missing:
        expected = f"expected a {dim} of the motion ({', '.join(known)})"
        raise CrashkitError(f"{observer.name}: {expected}, found {', '.join(missing)}")
    return np.array([known.index(name) for name in names])


def prediction_coordinates(observer: Observer, motion: xr.Dataset, instrument: xr.Dataset) -> xr.Coordinates:
    """The coordinates of a prediction, without indexes: building those takes longer than predicting."""
    variables = {"error": _error_names(type(observer))}
    for source, dims in ((instrument, instrument.variables[observer.quantity].dims), (motion, ("parameter",))):
        variables |= {str(dim): source.variables[dim] for dim in dims if dim in source.variables}
    return xr.Coordinates(variables, indexes={})


@cache
def _nulls(observer: type[Observer], channels: int, axes: int) -> np.ndarray:
    """(error, channel, axis)."""
    nulls = np.array([spec.null for spec in observer.errors], dtype=float)
    return np.repeat(nulls, channels * axes).reshape(len(nulls), channels, axes)


@cache
def _reached(place: str, channels: tuple[str, ...], axes: tuple[str, ...]) -> np.ndarray:
    """Which channels and axes an error of this place is of, (channel, axis)."""
    reached = [[place in ("", channel, f"{channel}/{axis}") for axis in axes] for channel in channels]
    return np.array(reached, dtype=bool).reshape(len(channels), len(axes))


@cache
def _error_names(observer: type[Observer]) -> xr.Variable:
    return xr.Variable("error", [spec.name for spec in observer.errors])
