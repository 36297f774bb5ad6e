"""Motions: what a simulation returns and what an observer reconstructs."""

from pathlib import Path

import xarray as xr

from crashkit.data.netcdf import read_tree, write_tree
from crashkit.data.schemas import MOTION
from crashkit.data.validate import check


def read_motion(path: str | Path) -> xr.Dataset:
    """A motion from a netCDF file, checked, in memory, the file closed.

    Raises:
        ContractError: with every fault, if it breaks the contract.
        CrashkitError: if it cannot be read at all.
    """
    motion = read_tree(path).to_dataset()
    check(motion, MOTION, str(path))
    return motion


def write_motion(motion: xr.Dataset, path: str | Path) -> None:
    """Write a motion as netCDF-4, whole or not at all.

    Raises:
        ContractError: with every fault, if it breaks the contract.
        CrashkitError: if it cannot be written.
    """
    check(motion, MOTION, str(path))
    write_tree(xr.DataTree(motion), path)
