"""What an observer answers, where it keeps to its protocol; else one line that names it."""

from collections.abc import Hashable, Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError, one_line
from crashkit.protocols import Observer, SensorErrors


def predicted_by(
    observer: Observer, place: str, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors
) -> Mapping[Hashable, xr.Variable]:
    """The variables of a prediction; raises CrashkitError where `predict` raises anything."""
    try:
        return observer.predict(motion, instrument, errors).variables
    except CrashkitError:
        raise
    except Exception as error:  # whatever a plugin raises
        raise CrashkitError(f"{place}: observer {observer.name}: predict raised {one_line(error)}") from error


def values_of(
    observer: Observer, place: str, read: Mapping[Hashable, xr.Variable], name: str, like: xr.Variable, more: Sequence[str]
) -> np.ndarray:
    """One variable of a prediction; raises CrashkitError where it is missing, or not as was recorded with `more` dims behind.

    Arguments:
        place: run and instrument, which the error names.
        like: the recorded variable.
    """
    variable, dims = read.get(name), (*like.dims, *more)
    if variable is not None and variable.dims == dims and variable.shape[: like.ndim] == like.shape:
        return np.asarray(variable.values)
    found = "none" if variable is None else _form(variable.dims, variable.shape)
    expected = f"{name} {_form(dims, like.shape)} of predict"
    raise CrashkitError(f"{place}: observer {observer.name}: expected {expected}, found {found}")


def _form(dims: Sequence[Hashable], shape: Sequence[int]) -> str:
    """Dims with their lengths, as far as these are known: (time 201, sensor 1, axis 1, parameter)."""
    known = [*map(str, shape), *("" for _ in dims[len(shape) :])]
    return f"({', '.join(f'{dim} {size}'.rstrip() for dim, size in zip(dims, known, strict=True))})"
