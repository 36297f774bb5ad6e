"""Whether a model and its recordings belong together: told before any work is done with them."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import combinations

import xarray as xr

from crashkit.data.validate import names
from crashkit.errors import ContractError, CrashkitError, Fault, raise_together
from crashkit.misfit.channel import Group, groups_of
from crashkit.model import Model
from crashkit.model.checks import check_recording_against_model, instrument_place
from crashkit.model.choice import choice_fault
from crashkit.protocols import Observer


def check_together(
    model: Model, recordings: Mapping[str, xr.DataTree], observers: Mapping[str, type[Observer]], source: str
) -> None:
    """Refuse what `check_runs` does, and instruments of the model that are in no recording; else like it.

    States of bodies that the model does not have, which are not used, are warned of.

    Arguments:
        source: the model's file.
    """
    faults = list(_instrument_faults(model, check_runs(model, recordings, observers)))
    if faults:
        raise ContractError(source, faults)
    for name, tree in recordings.items():
        _warn_of_strangers(name, tree, model)


def check_runs(model: Model, recordings: Mapping[str, xr.DataTree], observers: Mapping[str, type[Observer]]) -> list[Group]:
    """Refuse recordings that are not of the model, and a run that is given twice.

    Arguments:
        model: to be compared with the recordings.
        recordings: by run name, fitted or held out.
        observers: the installed observers by name.

    Returns:
        the instruments of all runs.

    Raises CrashkitError with a line for each fault.
    """
    groups: list[Group] = []
    runs = [partial(_check_run, groups, name, tree, model, observers) for name, tree in recordings.items()]
    raise_together([*runs, partial(_check_copies, recordings)])
    return groups


def _check_run(
    groups: list[Group], name: str, tree: xr.DataTree, model: Model, observers: Mapping[str, type[Observer]]
) -> None:
    check_recording_against_model(tree, model, name)
    groups.extend(groups_of(name, tree, observers, model))


def _warn_of_strangers(name: str, tree: xr.DataTree, model: Model) -> None:
    found = tree["initial"].coords["body"].values.tolist() if "initial" in tree.children else []
    known = [body.name for body in model.bodies]
    strangers = [body for body in found if body not in known]
    if strangers:
        expected = f"expected bodies of the model ({names(known)})"
        warnings.warn(f"{name}: initial/body: {expected}, found {names(strangers)}, which is not used", stacklevel=3)


def _check_copies(recordings: Mapping[str, xr.DataTree]) -> None:
    """A copy of a fitted run under another name predicts nothing."""
    for (first, one), (second, other) in combinations(recordings.items(), 2):
        if one.equals(other):
            raise CrashkitError(f"{second}: expected each run once, fitted or held out, found the values of {first}")


def _instrument_faults(model: Model, groups: Sequence[Group]) -> Iterator[Fault]:
    sensors: dict[str, set[str]] = {}
    for group in groups:
        sensors.setdefault(group.name, set()).update(channel.sensor for channel in group.channels)
    for entry in model.instruments:
        where = instrument_place(entry.instrument, entry.sensor)
        known = sensors.get(entry.instrument)
        if known is None:
            yield choice_fault(where, "instruments of the recordings", entry.instrument, sorted(sensors))
        elif entry.sensor and not known & {entry.sensor, entry.sensor.rpartition("/")[0]}:
            yield choice_fault(where, f"sensors of {entry.instrument} in the recordings", entry.sensor, sorted(known))
