"""The curve files of an NHTSA test: two columns, time (s) and value, loose in the folder or packed in tar archives."""

import re
import tarfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from crashkit.errors import CrashkitError

CURVE_FILE = re.compile(r"v\d+\.(\d{3,})", re.IGNORECASE)
ARCHIVES = (".tar", ".tgz", ".tar.gz", ".tar.bz2", ".tar.xz")


@frozen
class CurveFile:
    """The content of one curve's file, and where it stands."""

    place: str
    content: bytes

    @property
    def samples(self) -> int:
        """Number of lines that hold something."""
        return sum(1 for line in self.content.splitlines() if line.strip())

    def values(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Time (s) and value; raises CrashkitError that names file and line."""
        lines = [(number, line) for number, line in enumerate(self.content.splitlines(), start=1) if line.strip()]
        if len(lines) < 2:
            raise CrashkitError(f"{self.place}: expected at least two samples, found {len(lines)}")
        table = np.array([self._sample(number, line) for number, line in lines])
        self._check(table, [number for number, _ in lines])
        return table[:, 0], table[:, 1]

    def _sample(self, number: int, line: bytes) -> tuple[float, float]:
        try:
            time, value = line.split()
            return float(time), float(value)
        except ValueError:
            found = line.decode("latin-1").strip()
            raise CrashkitError(f"{self.place}, line {number}: expected time and value, found {found!r}") from None

    def _check(self, table: NDArray[np.float64], numbers: list[int]) -> None:
        finite = np.isfinite(table).all(axis=1)
        if not finite.all():
            worst = int(np.argmin(finite))
            found = " ".join(map(str, table[worst].tolist()))
            raise CrashkitError(f"{self.place}, line {numbers[worst]}: expected finite numbers, found {found}")
        forward = np.diff(table[:, 0]) > 0
        if not forward.all():
            worst = int(np.argmin(forward)) + 1
            raise CrashkitError(f"{self.place}, line {numbers[worst]}: expected increasing time, found {table[worst, 0]:g} s")


def curve_files(folder: Path) -> dict[int, CurveFile]:
    """The curve files of `folder` by curve number; a loose file wins over the same curve in an archive."""
    files: dict[int, CurveFile] = {}
    for path in sorted(folder.iterdir()):
        if path.name.lower().endswith(ARCHIVES):
            files = dict(_packed(path)) | files
        elif match := CURVE_FILE.fullmatch(path.name):
            files[int(match[1])] = CurveFile(path.name, path.read_bytes())
    return files


def _packed(path: Path) -> Iterator[tuple[int, CurveFile]]:
    try:
        with tarfile.open(path) as archive:
            for member in archive:
                name = PurePosixPath(member.name).name
                content = archive.extractfile(member)
                if content is not None and (match := CURVE_FILE.fullmatch(name)):
                    yield int(match[1]), CurveFile(f"{path.name}:{name}", content.read())
    except (tarfile.TarError, EOFError, OSError) as error:
        raise CrashkitError(f"{path.name}: expected a readable tar archive, found {error}") from None
