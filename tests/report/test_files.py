"""A reader never sees half a file."""

from pathlib import Path

import pytest

from crashkit.errors import CrashkitError
from crashkit.report.files import write_text


def test_it_makes_the_folder_and_replaces_an_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "page.html"
    write_text(path, "old")
    assert write_text(path, "new: ± 2 σ") == path
    assert path.read_text("utf-8") == "new: ± 2 σ"
    assert list(path.parent.iterdir()) == [path]


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_text(tmp_path / "page.html", "old")

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("os.replace", fail)
    with pytest.raises(CrashkitError, match="disk full"):
        write_text(path, "new")
    assert path.read_text("utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]
