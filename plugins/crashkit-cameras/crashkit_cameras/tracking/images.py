"""Films from image files and videos, read by OpenCV: the optional extra `images`."""

from collections.abc import Iterable, Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from attrs import field, frozen

from crashkit.errors import CrashkitError
from crashkit_cameras.tracking.frame import Frame

GREEN, RED = (80, 220, 60), (60, 60, 240)
USUAL_RADIUS = 10.0
"""pixel; of the circle around a target whose radius is not known."""
SHIFT = 4
"""Bits of a pixel's fraction in OpenCV's drawing."""


def _paths(given: Iterable[str | Path]) -> tuple[Path, ...]:
    return tuple(Path(path) for path in given)


def _positive(_: object, attribute: Any, value: float) -> None:
    if not value > 0.0:
        raise CrashkitError(f"{attribute.name} of a film: expected frames per second above 0, found {value:g}")


@frozen
class ImageFiles:
    """A film with a file for each frame, read frame by frame, as often as needed, forward or `reversed`.

    Arguments:
        paths: of the files, in the order of time.
        rate: frames per second of the test (not of a slow-motion replay).
        first: time of the first frame, s.
    """

    paths: tuple[Path, ...] = field(converter=_paths)
    rate: float = field(validator=_positive)
    first: float = 0.0

    def __len__(self) -> int:
        return len(self.paths)

    def __iter__(self) -> Iterator[Frame]:
        return (self[index] for index in range(len(self)))

    def __reversed__(self) -> Iterator[Frame]:
        return (self[index] for index in reversed(range(len(self))))

    def __getitem__(self, index: int) -> Frame:
        """A frame, grey, as deep as it is stored. Raises CrashkitError for a file that OpenCV cannot read."""
        path, cv2 = self.paths[index], _opencv()
        image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH) if path.is_file() else None
        if image is None:
            raise CrashkitError(f"{path}: expected an image that OpenCV can read, found none")
        return Frame(self.first + range(len(self))[index] / self.rate, image)


@frozen
class Video:
    """A film in one video file, read from its beginning each time.

    Arguments:
        path: of the file.
        rate: frames per second of the test (not of a slow-motion replay).
        first: time of the first frame, s.
    """

    path: Path = field(converter=Path)
    rate: float = field(validator=_positive)
    first: float = 0.0

    def __iter__(self) -> Iterator[Frame]:
        """The frames, grey. Raises CrashkitError for a file that OpenCV cannot read."""
        cv2 = _opencv()
        video = cv2.VideoCapture(str(self.path)) if self.path.is_file() else None
        if video is None or not video.isOpened():
            raise CrashkitError(f"{self.path}: expected a video that OpenCV can read, found none")
        count = 0
        while (read := video.read())[0]:
            yield Frame(self.first + count / self.rate, cv2.cvtColor(read[1], cv2.COLOR_BGR2GRAY))
            count += 1
        video.release()


def write_images(frames: Iterable[Frame], folder: Path) -> list[Path]:
    """Write a film as PNG files frame_0000.png and so on, without loss, and return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for number, frame in enumerate(frames):
        paths.append(folder / f"frame_{number:04}.png")
        _write(paths[-1], frame.image)
    return paths


def write_overlay(image: np.ndarray, targets: xr.Dataset, path: Path) -> None:
    """Write an image with the targets found in it: a circle of their radius, a cross and the name of each.

    Arguments:
        image: brightness, (row v, column u).
        targets: over `marker`, from `detect`, or from `follow` at one time; those without a place are left out.
        path: of the image to write; its ending says the format.
    """
    cv2 = _opencv()
    bright = image.astype(float) * (255.0 / max(float(image.max()), 1.0))
    picture = cv2.cvtColor(bright.astype(np.uint8), cv2.COLOR_GRAY2BGR)
    for name in targets["marker"].values.tolist():
        place, radius = targets["image_position"].sel(marker=name).values, float(targets["radius"].sel(marker=name))
        if not np.all(np.isfinite(place)):
            continue
        radius = radius if np.isfinite(radius) else USUAL_RADIUS
        u, v, r = (round(value * 2**SHIFT) for value in (*place, radius))
        cv2.circle(picture, (u, v), r, GREEN, 1, cv2.LINE_AA, SHIFT)
        for du, dv in ((r // 2, 0), (0, r // 2)):
            cv2.line(picture, (u - du, v - dv), (u + du, v + dv), RED, 1, cv2.LINE_AA, SHIFT)
        corner = (round(place[0] + radius), round(place[1] - radius))
        cv2.putText(picture, name, corner, cv2.FONT_HERSHEY_SIMPLEX, 0.45, GREEN, 1, cv2.LINE_AA)
    _write(path, picture)


def _write(path: Path, image: np.ndarray) -> None:
    if not _opencv().imwrite(str(path), image):
        raise CrashkitError(f"{path}: expected a format and a folder that OpenCV can write to, found none")


def _opencv() -> Any:
    try:
        return import_module("cv2")
    except ImportError:
        raise CrashkitError("images need OpenCV: pip install 'crashkit-cameras[images]'") from None
