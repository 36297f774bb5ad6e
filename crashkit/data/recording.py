"""Recordings: one test, one file, one group for each instrument."""

from collections.abc import Iterator, Mapping
from itertools import combinations
from pathlib import Path

import numpy as np
import xarray as xr

from crashkit.data.netcdf import read_tree, write_tree
from crashkit.data.schema import GroupSchema
from crashkit.data.schemas import INITIAL, RECORDING
from crashkit.data.validate import faults_of, plain_value, shown
from crashkit.errors import ContractError, Fault

LONG, SHARED = 10.0, 0.01
"""s, and the share of them: instruments that together take longer and share less do not count the same seconds."""


def read_recording(path: str | Path, schemas: Mapping[str, GroupSchema]) -> xr.DataTree:
    """A recording from a netCDF file, checked, in memory, the file closed.

    Arguments:
        path: the file.
        schemas: of the installed Observers, by the value of a group's attribute `observer`.

    Raises:
        ContractError: with every fault, if it breaks the contract.
        CrashkitError: if it cannot be read at all.
    """
    tree = read_tree(path)
    check_recording(tree, schemas, str(path))
    return tree


def write_recording(tree: xr.DataTree, path: str | Path) -> None:
    """Write a recording as netCDF-4, whole or not at all; raises CrashkitError."""
    write_tree(tree, path)


def check_recording(tree: xr.DataTree, schemas: Mapping[str, GroupSchema], source: str) -> None:
    """Refuse a recording that breaks the contract: raises ContractError with every fault of every group."""
    faults = recording_faults(tree, schemas)
    if faults:
        raise ContractError(source, faults)


def recording_faults(tree: xr.DataTree, schemas: Mapping[str, GroupSchema]) -> list[Fault]:
    """Every fault of a recording; groups of observers that are not installed are kept unchecked."""
    return list(_faults(tree, schemas))


def instruments(tree: xr.DataTree) -> dict[str, str]:
    """The observer of each instrument, by the name of its group."""
    return {name: str(group.attrs["observer"]) for name, group in tree.children.items() if "observer" in group.attrs}


def unknown_observers(tree: xr.DataTree, schemas: Mapping[str, GroupSchema]) -> dict[str, str]:
    """The instruments that no installed Observer understands: observer by group."""
    return {group: observer for group, observer in instruments(tree).items() if observer not in schemas}


def _faults(tree: xr.DataTree, schemas: Mapping[str, GroupSchema]) -> Iterator[Fault]:
    yield from faults_of(tree.to_dataset(), RECORDING)
    if not instruments(tree):
        found = "a motion" if "position" in tree.data_vars else "none"
        yield Fault("recording", "an instrument, a group with the attribute observer", found)
    yield from _misplaced_observers(tree)
    if "initial" in tree.children:
        yield from faults_of(tree["initial"].to_dataset(), INITIAL)
    yield from _instrument_faults(tree, schemas)


def _instrument_faults(tree: xr.DataTree, schemas: Mapping[str, GroupSchema]) -> Iterator[Fault]:
    """Of each instrument alone; where there are none, of their times together."""
    kinds = {group: observer for group, observer in instruments(tree).items() if observer in schemas}
    groups = {group: tree[group].to_dataset() for group in kinds}
    own = [fault for group, dataset in groups.items() for fault in faults_of(dataset, schemas[kinds[group]], group)]
    yield from own
    if not own:
        yield from _times_apart(
            {group: dataset["time"].values for group, dataset in groups.items() if "time" in dataset.indexes}
        )


def _times_apart(times: Mapping[str, np.ndarray]) -> Iterator[Fault]:
    """Of instruments that saw the same crash, one with its time in other units, or counted from another day."""
    ends = {group: (float(stamps[0]), float(stamps[-1])) for group, stamps in times.items()}
    for pair in combinations(ends, 2):
        other, odd = sorted(pair, key=lambda group: max(map(abs, ends[group])))
        starts, stops = zip(ends[other], ends[odd], strict=True)
        whole, common = max(stops) - min(starts), min(stops) - max(starts)
        if whole > LONG and common < SHARED * whole:
            expected = f"the seconds of {other} ({ends[other][0]:g} to {ends[other][1]:g} s)"
            yield Fault(f"{odd}/time", expected, f"{ends[odd][0]:g} to {ends[odd][1]:g} s")


def _misplaced_observers(tree: xr.DataTree) -> Iterator[Fault]:
    """An instrument that nobody would find: an attribute that is no text, or not on a group of the first level."""
    for node in tree.subtree:
        observer = plain_value(node.attrs.get("observer", ""))
        if not isinstance(observer, str):
            yield Fault(node.path.strip("/"), "attribute observer as text", shown(observer))
        elif observer and node.level != 1:
            yield Fault(
                node.path.strip("/") or "recording", "attribute observer on groups of the first level only", shown(observer)
            )
