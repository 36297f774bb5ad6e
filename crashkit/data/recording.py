"""Recordings: one test, one file, one group for each instrument."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import xarray as xr

from crashkit.data.netcdf import read_tree, write_tree
from crashkit.data.schema import GroupSchema
from crashkit.data.schemas import INITIAL, RECORDING
from crashkit.data.validate import faults_of, plain_value, shown
from crashkit.errors import ContractError, Fault


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
    yield from _misplaced_observers(tree)
    if "initial" in tree.children:
        yield from faults_of(tree["initial"].to_dataset(), INITIAL)
    for group, observer in instruments(tree).items():
        if observer in schemas:
            yield from faults_of(tree[group].to_dataset(), schemas[observer], group)


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
