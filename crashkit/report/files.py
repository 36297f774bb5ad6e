"""Files that are either whole or not there."""

from pathlib import Path

from crashkit.data.files import atomic_write


def write_text(path: Path, text: str) -> Path:
    """Write a file and its folders, whole or not at all, and return its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic_write(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))
    return path
