"""Writing a file whole or not at all, beside what is there, never over what was read."""

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from crashkit.errors import CrashkitError


def atomic_write(path: str | Path, writer: Callable[[Path], object]) -> None:
    """Let `writer` fill a temporary file beside `path`, then put it in place in one step.

    Whatever goes wrong, `path` is either the old file or the whole new one, and the temporary file is removed.

    Arguments:
        path: the file to write.
        writer: is given the path of the temporary file, which does not exist yet, and writes it.

    Raises:
        CrashkitError: if the file cannot be written.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise CrashkitError(f"{path}: cannot be written: no folder {path.parent}")
    temporary = path.with_name(f".{path.name}.{uuid4().hex}")
    try:
        writer(temporary)
        os.replace(temporary, path)
    except OSError as error:
        raise CrashkitError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


@contextmanager
def folder_to_fill(folder: Path) -> Iterator[None]:
    """Make a folder, with those above it; where the work within fails, those that are new and still empty are gone again.

    Raises:
        CrashkitError: if the folder cannot be made.
    """
    new = [one for one in (folder, *folder.parents) if not one.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        is_file = isinstance(error, FileExistsError | NotADirectoryError)
        found = "a file" if is_file else f"one that cannot be made ({(error.strerror or str(error)).lower()})"
        raise CrashkitError(f"{folder}: expected a folder to write to, found {found}") from error
    try:
        yield
    except BaseException:
        with suppress(OSError):  # one that is not empty stays, and so do those above it
            for one in new:
                one.rmdir()
        raise


def check_outputs(inputs: Iterable[Path], outputs: Iterable[Path | None]) -> None:
    """Refuse to write a file over one that is read, or over another output; raises CrashkitError.

    Arguments:
        inputs: files that are read.
        outputs: files to be written; None: one that is not wanted.
    """
    taken = {_identity(path): "one of the inputs" for path in inputs}
    for path in filter(None, outputs):
        if _identity(path) in taken:
            raise CrashkitError(f"{path}: expected a file of its own for the output, found {taken[_identity(path)]}")
        taken[_identity(path)] = "another output"


def _identity(path: Path) -> object:
    """The same for every name of a file, links among them."""
    return (path.stat().st_dev, path.stat().st_ino) if path.exists() else path.resolve()
