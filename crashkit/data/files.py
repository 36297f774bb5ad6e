"""Writing a file whole or not at all."""

import os
from collections.abc import Callable
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
