import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from crashkit.data.files import atomic_write
from crashkit.errors import CrashkitError

KILLED = """
import os, signal, sys
from pathlib import Path
from crashkit.data.files import atomic_write

def write_half(temporary):
    temporary.write_text("half of the n")
    os.kill(os.getpid(), signal.SIGKILL)

atomic_write(Path(sys.argv[1]), write_half)
"""


def write_text(text: str):
    return lambda path: path.write_text(text)


def test_writes_the_file_and_nothing_else(tmp_path):
    atomic_write(tmp_path / "a.txt", write_text("new"))
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("a.txt", "new")]


def test_replaces_an_old_file(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    atomic_write(str(tmp_path / "a.txt"), write_text("new"))
    assert (tmp_path / "a.txt").read_text() == "new"


def test_others_may_read_what_they_could_read_of_any_new_file(tmp_path):
    atomic_write(tmp_path / "a.txt", write_text("new"))
    (tmp_path / "b.txt").write_text("new")
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == stat.S_IMODE((tmp_path / "b.txt").stat().st_mode)


@pytest.mark.parametrize("error", [ValueError("no"), KeyboardInterrupt("no")])
def test_a_writer_that_fails_leaves_the_old_file_alone(tmp_path, error):
    def fail(temporary: Path) -> None:
        temporary.write_text("half")
        raise error

    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(type(error), match="no"):
        atomic_write(tmp_path / "a.txt", fail)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("a.txt", "old")]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes cannot be killed so on this system")
def test_a_process_killed_in_the_middle_leaves_the_old_file_alone(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    ended = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path / "a.txt")], env=environment, check=False)
    assert ended.returncode == -signal.SIGKILL
    assert (tmp_path / "a.txt").read_text() == "old"


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(CrashkitError, match=r"none/a.txt: cannot be written: no folder .*none$"):
        atomic_write(tmp_path / "none" / "a.txt", write_text("new"))


def test_a_folder_in_its_place(tmp_path):
    (tmp_path / "a.txt").mkdir()
    with pytest.raises(CrashkitError, match=r"a.txt: cannot be written: "):
        atomic_write(tmp_path / "a.txt", write_text("new"))
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_a_full_disk(tmp_path):
    def fail(temporary: Path) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(CrashkitError, match=r"a.txt: cannot be written: No space left on device$"):
        atomic_write(tmp_path / "a.txt", fail)
