"""The folder in which compiled code is kept."""

import hashlib
import importlib.util
import os
import sys
import tempfile
from pathlib import Path
from types import ModuleType

import platformdirs

from crashkit.data.files import atomic_write

DATED = 1_000_000_000
"""Modification time of a file that is kept: the same whoever writes it, so that what was compiled of it stays valid."""


def kept(name: str) -> bytes | None:
    """What a file of the folder holds; None where there is none."""
    try:
        return (folder() / name).read_bytes()
    except FileNotFoundError:
        return None


def keep(name: str, content: bytes) -> None:
    """Write a file at once, so that a process running beside this one sees all of it or nothing."""

    def write(draft: Path) -> None:
        draft.write_bytes(content)
        os.utime(draft, (DATED, DATED))

    atomic_write(folder() / name, write)


def module_of(name: str, source: str) -> ModuleType:
    """A module that is written there, so that numba keeps beside it what it compiles."""
    path = folder() / f"{name}.py"
    if not path.exists():
        keep(path.name, source.encode())
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def digest(*texts: str) -> str:
    """A name for what is compiled of these texts."""
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()[:20]


def folder() -> Path:
    """The first folder that can be written to: the one that the environment variable CRASHKIT_CACHE names, else the user's
    cache folder, else a temporary one."""
    wanted = os.environ.get("CRASHKIT_CACHE") or platformdirs.user_cache_path("crashkit") / "engines"
    for path in (Path(wanted), Path(tempfile.gettempdir()) / f"crashkit-engines-{os.getpid()}"):
        try:
            path.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=path):
                return path
        except OSError:
            continue
    raise OSError(f"no folder for compiled engines can be written: {wanted}")
