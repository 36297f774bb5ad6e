"""A campaign: one function over many items, each result a file of its own."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor, as_completed
from pathlib import Path
from typing import TypeVar

import xarray as xr

from crashkit.data.netcdf import read_tree, write_tree
from crashkit.errors import CrashkitError

Item = TypeVar("Item")


def run(
    function: Callable[[Item], xr.Dataset], items: Mapping[str, Item], folder: Path, executor: Executor | None = None
) -> dict[str, xr.Dataset]:
    """The results of `function` by item, in the order of the items.

    Each result is written to `folder/NAME.nc` as soon as it is there, whole or not at all; a campaign that was interrupted
    goes on where it stopped. Delete a file to have it computed again.

    Arguments:
        function: of one item; one that a process pool can import, if `executor` is one.
        items: by the name of their file.
        folder: made if it is not there.
        executor: who computes; None: this thread, one after the other.

    Raises:
        CrashkitError: a name that is no file name, or a result that cannot be written or read.
        Exception: whatever `function` raises; results that were there before are kept, what has not begun is given up.
    """
    files = {name: _file(folder, name) for name in items}
    folder.mkdir(parents=True, exist_ok=True)
    missing = [name for name, file in files.items() if not file.exists()]
    for name, result in _computed(function, {name: items[name] for name in missing}, executor):
        write_tree(xr.DataTree(result), files[name])
    return {name: read_tree(file).to_dataset() for name, file in files.items()}


def _computed(
    function: Callable[[Item], xr.Dataset], items: Mapping[str, Item], executor: Executor | None
) -> Iterable[tuple[str, xr.Dataset]]:
    if executor is None:
        return ((name, function(item)) for name, item in items.items())
    return _as_they_come(function, items, executor)


def _as_they_come(
    function: Callable[[Item], xr.Dataset], items: Mapping[str, Item], executor: Executor
) -> Iterator[tuple[str, xr.Dataset]]:
    names = {executor.submit(function, item): name for name, item in items.items()}
    try:
        for future in as_completed(names):
            yield names[future], future.result()
    finally:
        for future in names:
            future.cancel()


def _file(folder: Path, name: str) -> Path:
    if not name or name.startswith(".") or Path(name).name != name:
        raise CrashkitError(f"expected names of items that can be file names, found {name!r}")
    return folder / f"{name}.nc"
