"""Targets proposed from one image."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit_cameras.tracking.fit import Fit, fit
from crashkit_cameras.tracking.pattern import Pattern
from crashkit_cameras.tracking.patterns import pattern_of
from crashkit_cameras.tracking.search import Candidate, search, search_around

RADII = (5.0, 40.0)
"""pixel; the smallest and the largest disc that is looked for."""
SCALE = 1.3
"""Between one radius that is looked for and the next."""
MOST_CANDIDATES, MOST_TRIED = 300, 20
"""Places that are tried in a whole image, and around a point."""
MEASURES, SETTLED = 8, 0.1
"""How often a size is measured, and the change of its logarithm from which on it is kept."""
LEAST_QUALITY = 0.8
MOST_STD = 0.1
"""pixel; an image has many smooth saddles and spots that nobody painted."""
ACROSS = 20.0
"""pixel; how far from the place that a user shows a target may be."""


def detect(image: np.ndarray, kind: str = "quadrant", radius: tuple[float, float] = RADII) -> xr.Dataset:
    """Propose the targets of an image.

    Arguments:
        image: brightness, (row v, column u).
        kind: "quadrant" or "dot".
        radius: of the smallest and the largest disc that is looked for, pixel.

    Returns:
        Dataset over `marker` (target_1 and so on, the best first), as `mark` gives it, with `image_position_std` and
        `quality`. Choose with `sel`, name with `assign_coords`, then `follow`.

    Raises CrashkitError for a kind that is not known.
    """
    pattern = pattern_of(kind)
    found = [
        one
        for one in _settled(pattern, image, search(pattern, image, _radii(*radius)))
        if radius[0] <= one.radius <= radius[1] and np.max(one.std) < MOST_STD
    ]
    found.sort(key=lambda one: -one.quality)
    found_radii = np.array([one.radius for one in found])
    names = [f"target_{number}" for number in range(1, len(found) + 1)]
    places = np.array([one.centre for one in found]).reshape(-1, 2)
    stds = np.array([one.std for one in found]).reshape(-1, 2)
    return _targets(names, places, found_radii, kind).assign(
        image_position_std=(("marker", "image_axis"), stds, {"units": "pixel"}),
        quality=("marker", [one.quality for one in found], {"units": "1"}),
    )


def mark(
    points: Mapping[str, tuple[float, float]], kind: str = "quadrant", radius: float = np.nan, time: float | None = None
) -> xr.Dataset:
    """Targets that a user shows.

    Arguments:
        points: u, v of each marker, pixel, right to some pixels.
        kind: "quadrant" or "dot".
        radius: of their discs, pixel, right to a quarter; unknown if not given.
        time: of the frame on which the targets are shown, s, for a correction later in a film.

    Returns:
        Dataset over `marker`: `image_position` (marker, image_axis) and `radius`, pixel; `kind`; the coordinate `time` if it
        is given.

    Raises CrashkitError for a kind that is not known.
    """
    pattern_of(kind)
    places = np.array(list(points.values()), dtype=float).reshape(-1, 2)
    targets = _targets(list(points), places, np.full(len(points), radius), kind)
    return targets if time is None else targets.assign_coords(time=time)


def acquire(pattern: Pattern, image: np.ndarray, point: np.ndarray, radius: float) -> Fit | None:
    """The likest target near a point; its radius may be unknown (NaN)."""
    known = np.isfinite(radius)
    within = max(ACROSS, radius) if known else ACROSS
    radii = [radius / SCALE, radius, radius * SCALE] if known else _radii(*RADII)
    candidates = search_around(pattern, image, radii, point, within)
    for candidate in candidates[:MOST_TRIED]:
        found = settle(pattern, image, candidate.shape(pattern))
        if found is not None and found.quality > LEAST_QUALITY:
            return found
    return None


def settle(pattern: Pattern, image: np.ndarray, shape: np.ndarray) -> Fit | None:
    """Fit a target and measure its size, by turns, until it keeps it; None if it does not, or goes elsewhere."""
    start = shape[:2]
    for _ in range(MEASURES):
        found = fit(pattern, image, shape)
        if found is None or np.hypot(*(found.centre - start)) > found.radius:
            return None
        shape = pattern.measured(found.shape, image)
        if abs(np.log(pattern.radius(shape) / found.radius)) < SETTLED:
            return evolve(found, shape=shape)
    return None


def _settled(pattern: Pattern, image: np.ndarray, candidates: Sequence[Candidate]) -> list[Fit]:
    """The targets among candidates, each once."""
    found: list[Fit] = []
    tried: list[Candidate] = []
    for candidate in candidates:
        taken = any(np.hypot(*(candidate.centre - one.centre)) < one.radius for one in found)
        if taken or any(_alike(candidate, one) for one in tried):
            continue
        tried.append(candidate)
        one = settle(pattern, image, candidate.shape(pattern))
        if one is not None and one.quality > LEAST_QUALITY:
            found.append(one)
        if len(tried) == MOST_CANDIDATES:
            break
    return found


def _alike(one: Candidate, other: Candidate) -> bool:
    near = np.hypot(*(one.centre - other.centre)) < 0.5 * other.radius
    return bool(near and 0.5 < one.radius / other.radius < 2.0)


def _radii(least: float, most: float) -> list[float]:
    count = int(np.ceil(np.log(most / least) / np.log(SCALE))) + 1
    return np.geomspace(least, most, max(count, 1)).tolist()


def _targets(names: Sequence[str], places: np.ndarray, radii: np.ndarray, kind: str) -> xr.Dataset:
    return xr.Dataset(
        {
            "image_position": (("marker", "image_axis"), places, {"units": "pixel"}),
            "radius": ("marker", radii, {"units": "pixel"}),
            "kind": ("marker", [kind] * len(names)),
        },
        {"marker": list(names), "image_axis": ["u", "v"]},
    )
