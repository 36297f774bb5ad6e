"""Targets followed through rendered films: crashkit beside OpenCV's cornerSubPix and matchTemplate, on the same images.

crashkit follows from the first image on. OpenCV's functions only refine, so in every image they are told the pixel in which
the target is, and they get what serves them best: images smoothed by 1.5 pixels, a window of half the radius around a corner,
and as template the first image around the target with the exact place of the target in it. The best match is refined by a
parabola. cornerSubPix is for corners: it takes no part where the target is a dot.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from itertools import product
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from attrs import field, frozen

from benchmarks import Row
from crashkit_cameras.tracking import Frame, Imaging, Painted, Pose, follow, mark, render, true_position

FRAMES, SEEDS = 40, range(3)
"""Of each film, and of their noise: matchTemplate depends on that of the one template of a film."""
SIZE = 100
RADIUS = 10.0
SMOOTHING = 1.5
"""Standard deviation, pixel; without it the peers' errors are two to five times as large."""
TEMPLATE, WINDOW = 1.6, 0.5
"""Reach of matchTemplate's template and of cornerSubPix's window, in radii."""
SEARCH = 3
"""Pixels on each side of the one that matchTemplate is told."""

Method = Callable[[list[Frame], np.ndarray, float, str], np.ndarray]
"""From a film, the true places, the radius and the kind of the target to the places found, (frame, u and v)."""


@frozen
class Condition:
    """What is difficult about a film; lengths in pixel, times in frames, angles in rad."""

    radius: float = RADIUS
    spin: float = 0.0
    tilt: float = 0.0
    swing: float = 6.0
    imaging: Mapping[str, object] = field(factory=dict)

    def film(self, kind: str, seed: int) -> tuple[list[Frame], np.ndarray]:
        """The images, and where the target is in them."""

        def pose(time: float) -> Pose:
            u, v = 0.5 * SIZE + self.swing * np.sin([0.11 * time, 0.083 * time + 1.0])
            return Pose((u, v), self.radius, 0.1 + self.spin * time, self.tilt, 0.6)

        imaging = Imaging(SIZE, SIZE, **{"noise": 2.0, "ground": 0.4, **self.imaging})  # type: ignore[arg-type]
        target, times = Painted("target", kind, pose), np.arange(float(FRAMES))
        return render([target], imaging, times, seed), true_position([target], times).values[:, 0]


CONDITIONS = {
    "noise of 2 levels": Condition(),
    "noise of 8 levels": Condition(imaging={"noise": 8.0}),
    "radius 6 px": Condition(radius=6.0),
    "defocus 2 px": Condition(imaging={"defocus": 2.0}),
    "motion blur to 3 px": Condition(swing=25.0, imaging={"exposure": 1.0}),
    "turning 30 degrees": Condition(spin=np.radians(0.5)),
    "tilted 50 degrees": Condition(tilt=np.radians(50.0)),
    "light 1 % for each px": Condition(imaging={"light": (0.01, 0.005)}),
    "gamma 2.2": Condition(imaging={"gamma": 2.2}),
}


def run() -> list[Row]:
    """Median and 95th percentile of the error in each condition, and the time for each target and image."""
    methods = {"crashkit": _follow, **_peers()}
    times: dict[str, list[float]] = {name: [] for name in methods}
    rows: list[Row] = []
    for kind, (name, condition) in product(("quadrant", "dot"), CONDITIONS.items()):
        errors: dict[str, list[np.ndarray]] = {}
        for film, truth in (condition.film(kind, seed) for seed in SEEDS):
            for method, locate in methods.items():
                if kind == "quadrant" or method != "cornerSubPix":
                    start = perf_counter()
                    found = locate(film, truth, condition.radius, kind) if locate else truth
                    times[method].append(1e3 * (perf_counter() - start) / FRAMES)
                    errors.setdefault(method, []).append(np.hypot(*(found - truth).T))
        known = {method: np.concatenate(one) if methods[method] else None for method, one in errors.items()}
        rows += _error_rows(f"{kind}, {name}", known)
    ours = median(times.pop("crashkit"))
    return rows + [
        Row("time for each target", "time", "ms", ours, peer, median(spent) if methods[peer] else None)
        for peer, spent in times.items()
    ]


def _error_rows(case: str, errors: Mapping[str, np.ndarray | None]) -> list[Row]:
    ours = errors["crashkit"]
    assert ours is not None
    return [
        Row(
            f"{case}: {label}",
            "error",
            "pixel",
            _quantile(ours, part),
            peer,
            None if theirs is None else _quantile(theirs, part),
        )
        for peer, theirs in errors.items()
        if peer != "crashkit"
        for label, part in (("median", 0.5), ("95th percentile", 0.95))
    ]


def _quantile(errors: np.ndarray, part: float) -> float:
    """A lost target has an infinite error."""
    return float(np.quantile(np.where(np.isnan(errors), np.inf, errors), part, method="higher"))


def _follow(film: list[Frame], truth: np.ndarray, radius: float, kind: str) -> np.ndarray:
    start = mark({"target": tuple(np.rint(truth[0]))}, kind, radius)
    return follow(film, start)["image_position"].values[:, 0]


def _peers() -> dict[str, Method | None]:
    """OpenCV's methods; None where it is not installed."""
    try:
        cv2 = import_module("cv2")
    except ImportError:
        return {"cornerSubPix": None, "matchTemplate": None}
    return {
        "cornerSubPix": lambda film, truth, radius, kind: _corners(cv2, film, truth, radius),
        "matchTemplate": lambda film, truth, radius, kind: _matches(cv2, film, truth, radius),
    }


def _corners(cv2: Any, film: list[Frame], truth: np.ndarray, radius: float) -> np.ndarray:
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
    starts, window = np.rint(truth).astype(np.float32), (round(WINDOW * radius),) * 2
    found = [
        cv2.cornerSubPix(_smooth(cv2, frame), start.reshape(1, 1, 2).copy(), window, (-1, -1), criteria)
        for frame, start in zip(film, starts, strict=True)
    ]
    return np.array(found).reshape(-1, 2)


def _matches(cv2: Any, film: list[Frame], truth: np.ndarray, radius: float) -> np.ndarray:
    pixels, reach = np.rint(truth).astype(int), round(TEMPLATE * radius)
    template = _around(_smooth(cv2, film[0]), pixels[0], reach)
    found = []
    for frame, pixel in zip(film, pixels, strict=True):
        part = _around(_smooth(cv2, frame), pixel, reach + SEARCH)
        found.append(pixel + _peak(cv2.matchTemplate(part, template, cv2.TM_CCOEFF_NORMED)) - SEARCH)
    return np.array(found) + truth[0] - pixels[0]


def _smooth(cv2: Any, frame: Frame) -> np.ndarray:
    return cv2.GaussianBlur(frame.image, (0, 0), SMOOTHING)


def _around(image: np.ndarray, pixel: np.ndarray, reach: int) -> np.ndarray:
    u, v = pixel
    return image[v - reach : v + reach + 1, u - reach : u + reach + 1]


def _peak(scores: np.ndarray) -> np.ndarray:
    """The top, u and v, of the parabolas through the highest score and its neighbours."""
    v, u = np.unravel_index(np.argmax(scores[1:-1, 1:-1]), (scores.shape[0] - 2, scores.shape[1] - 2))
    across, down = scores[v + 1, u : u + 3].astype(float), scores[v : v + 3, u + 1].astype(float)
    return np.array([u, v]) + 1 + [0.5 * (low - high) / (low - 2.0 * top + high) for low, top, high in (across, down)]
