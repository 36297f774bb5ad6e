import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from crashkit.data.files import atomic_write, check_outputs, folder_to_fill
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


class TestFolders:
    def test_is_made_with_those_above_it(self, tmp_path):
        with folder_to_fill(tmp_path / "new" / "out"):
            (tmp_path / "new" / "out" / "a.txt").write_text("a")
        assert (tmp_path / "new" / "out" / "a.txt").is_file()

    def test_one_that_was_made_in_vain_is_gone_again(self, tmp_path):
        with pytest.raises(KeyboardInterrupt, match="no"), folder_to_fill(tmp_path / "new" / "out"):
            raise KeyboardInterrupt("no")
        assert list(tmp_path.iterdir()) == []

    def test_one_that_was_there_stays(self, tmp_path):
        (tmp_path / "old").mkdir()
        with pytest.raises(ValueError, match="no"), folder_to_fill(tmp_path / "old"):
            raise ValueError("no")
        assert (tmp_path / "old").is_dir()

    def test_what_was_written_before_a_failure_stays(self, tmp_path):
        with pytest.raises(ValueError, match="no"), folder_to_fill(tmp_path / "new"):
            (tmp_path / "new" / "a.txt").write_text("a")
            raise ValueError("no")
        assert (tmp_path / "new" / "a.txt").read_text() == "a"

    @pytest.mark.parametrize("name", ["a.txt", "a.txt/out"])
    def test_a_file_in_its_place(self, tmp_path, name):
        (tmp_path / "a.txt").write_text("a")
        with (
            pytest.raises(CrashkitError, match=f"{name}: expected a folder to write to, found a file$"),
            folder_to_fill(tmp_path / name),
        ):
            pass

    def test_one_that_cannot_be_made(self, tmp_path, monkeypatch):
        def fail(*_, **__):
            raise PermissionError(13, "Permission denied")

        monkeypatch.setattr(Path, "mkdir", fail)
        message = r"out: expected a folder to write to, found one that cannot be made \(permission denied\)$"
        with pytest.raises(CrashkitError, match=message), folder_to_fill(tmp_path / "out"):
            pass


class TestOutputs:
    def test_files_of_their_own(self, tmp_path):
        (tmp_path / "in.nc").write_text("")
        check_outputs([tmp_path / "in.nc"], [tmp_path / "out.nc", None, tmp_path / "in.json"])

    @pytest.mark.parametrize("name", ["in.nc", "other/../in.nc", "symbolic.nc", "hard.nc"])
    def test_an_input_by_any_name(self, tmp_path, name):
        (tmp_path / "in.nc").write_text("")
        (tmp_path / "other").mkdir()
        (tmp_path / "symbolic.nc").symlink_to("in.nc")
        os.link(tmp_path / "in.nc", tmp_path / "hard.nc")
        message = f"{name}: expected a file of its own for the output, found one of the inputs$"
        with pytest.raises(CrashkitError, match=message):
            check_outputs([tmp_path / "in.nc"], [tmp_path / name])

    def test_two_outputs_in_one_file(self, tmp_path):
        message = r"a.nc: expected a file of its own for the output, found another output$"
        with pytest.raises(CrashkitError, match=message):
            check_outputs([], [tmp_path / "a.nc", tmp_path / "b.nc", tmp_path / "." / "a.nc"])
