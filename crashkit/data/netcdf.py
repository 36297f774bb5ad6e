"""netCDF-4 files as trees in memory: read whole and closed at once, because netCDF-C is not thread-safe."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from crashkit.data.files import atomic_write
from crashkit.data.validate import is_text
from crashkit.errors import CrashkitError


def read_tree(path: str | Path) -> xr.DataTree:
    """Every group of a netCDF file, in memory, with plain text and numbers (see `plain`).

    Raises:
        CrashkitError: if there is no such file, or it is no netCDF file, or it is damaged.
    """
    path = Path(path)
    if path.is_dir():
        raise CrashkitError(f"{path}: expected a netCDF file, found a folder")
    if path.suffix == ".toml":
        raise CrashkitError(f"{path}: expected a netCDF file, found a model (TOML)")
    if not path.exists():
        raise CrashkitError(f"{path}: expected a netCDF file, found no such file")
    try:
        with xr.open_datatree(path, engine="netcdf4", decode_times=False) as tree:
            return plain(tree.load())
    except Exception as error:  # a damaged file can fail anywhere: in HDF5, in netCDF, or while xarray decodes it
        raise CrashkitError(f"{path}: expected a netCDF file, found one that cannot be read ({_reason(error)})") from error


def write_tree(tree: xr.DataTree, path: str | Path) -> None:
    """Write a tree as a netCDF-4 file, whole or not at all.

    Raises:
        CrashkitError: if the file cannot be written, or the tree holds what netCDF cannot store.
    """

    def write(temporary: Path) -> None:
        try:
            plain(tree).to_netcdf(temporary, engine="netcdf4")
        except (TypeError, ValueError, RuntimeError) as error:
            raise CrashkitError(f"{path}: cannot be written as netCDF ({_reason(error)})") from error

    atomic_write(path, write)


def plain(tree: xr.DataTree) -> xr.DataTree:
    """The same tree with text as numpy text and attributes as Python's own numbers, and no trace of how a file stored it."""
    return xr.DataTree.from_dict({node.path: _plain_dataset(node.to_dataset(inherit=False)) for node in tree.subtree})


def _plain_dataset(dataset: xr.Dataset) -> xr.Dataset:
    variables = {name: _plain_variable(variable) for name, variable in dataset.variables.items()}
    coords = {name: variables.pop(name) for name in dataset.coords}
    return xr.Dataset(variables, coords, _plain_attributes(dataset.attrs))


def _plain_variable(variable: xr.Variable) -> xr.Variable:
    values = variable.values
    if values.dtype.kind == "S":
        values = np.char.decode(values, "utf-8")
    elif is_text(values):
        values = values.astype(str)
    return xr.Variable(variable.dims, values, _plain_attributes(variable.attrs))


def _plain_attributes(attributes: dict[Any, Any]) -> dict[Any, Any]:
    return {name: _plain_attribute(value) for name, value in attributes.items()}


def _plain_attribute(value: object) -> object:
    if isinstance(value, bool | np.bool_):  # netCDF has no truth values
        return int(value)
    return value.item() if isinstance(value, np.generic) else value


def _reason(error: Exception) -> str:
    return (getattr(error, "strerror", None) or str(error) or type(error).__name__).splitlines()[0]
