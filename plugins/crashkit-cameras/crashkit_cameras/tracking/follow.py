"""Targets followed through a film."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit_cameras.tracking.detect import acquire
from crashkit_cameras.tracking.fit import Fit
from crashkit_cameras.tracking.frame import Frame
from crashkit_cameras.tracking.marker import Limits, Marker
from crashkit_cameras.tracking.patterns import pattern_of

UNSHOWN = "not shown yet"
UNFOUND = "not found where it was shown"
TAKEN = "another marker is there"
SAME_TIME = 1e-6
"""s"""

Sightings = dict[str, Fit | str]
"""What was found of each marker in a frame: a target, or why not."""


def follow(frames: Iterable[Frame], start: xr.Dataset, *corrections: xr.Dataset, limits: Limits | None = None) -> xr.Dataset:
    """Follow targets through a film, forward or backward in time.

    A target is expected where its path so far leads, fitted there, and if that fails looked for around. One that is lost is
    looked for further and further around, until it is found again.

    Arguments:
        frames: the film, in the order of its times or in reverse.
        start: targets on the first frame, from `mark` or `detect`.
        corrections: from `mark`, each with the scalar coordinate `time`, s, of the frame to which it belongs: markers that
            were lost or went astray, and new ones.
        limits: when a target counts as seen.

    Returns:
        Dataset over time and marker: `image_position` (time, marker, image_axis) and its standard deviation
        `image_position_std`, pixel, NaN while a marker is lost; `quality`, 0 to 1; `radius`, pixel; `lost`, the reason or "".

    Raises CrashkitError where a target of the start is not found, and for a film without frames.
    """
    limits = limits or Limits()
    names = list(dict.fromkeys(name for shown in (start, *corrections) for name in shown["marker"].values.tolist()))
    waiting = list(corrections)
    markers: dict[str, Marker] = {}
    times: list[float] = []
    film: list[Sightings] = []
    for frame in frames:
        _check(frame)
        sightings = _step(frame, markers, limits)
        due = [shown for shown in waiting if abs(float(shown["time"]) - frame.time) < SAME_TIME]
        for shown in due if film else [start, *due]:
            sightings |= _shown(frame, shown, markers)
        if not film:
            _refuse_unfound(sightings)
        waiting = [shown for shown in waiting if not any(shown is one for one in due)]
        times.append(frame.time)
        film.append(sightings)
    _refuse_unused(film, waiting)
    return _dataset(times, names, film).sortby("time")


def _step(frame: Frame, markers: Mapping[str, Marker], limits: Limits) -> Sightings:
    """Look for each marker where it is expected, then for those not seen around there; remember what was seen."""
    sightings: Sightings = {name: marker.here(frame, limits) for name, marker in markers.items()}
    _part(frame, markers, sightings)
    taken = [found.centre for found in sightings.values() if isinstance(found, Fit)]
    for name, marker in markers.items():
        found = sightings[name]
        if not isinstance(found, Fit):
            found = sightings[name] = marker.around(frame, limits, taken)
            if isinstance(found, Fit):
                taken.append(found.centre)
        sightings[name] = marker.remember(frame, found)
    return sightings


def _part(frame: Frame, markers: Mapping[str, Marker], sightings: Sightings) -> None:
    """Of two markers on one target, the one that was expected further away is not there."""
    seen = {name: found for name, found in sightings.items() if isinstance(found, Fit)}
    for pair in combinations(seen, 2):
        apart = np.hypot(*(seen[pair[0]].centre - seen[pair[1]].centre))
        if apart < 0.5 * min(markers[name].radius for name in pair):
            strays = {name: np.hypot(*(seen[name].centre - markers[name].path.expected(frame.time))) for name in pair}
            sightings[max(pair, key=lambda name: strays[name])] = TAKEN


def _shown(frame: Frame, shown: xr.Dataset, markers: dict[str, Marker]) -> Sightings:
    """Begin to follow the targets that a user shows on a frame."""
    sightings: Sightings = {}
    for name in shown["marker"].values.tolist():
        one = shown.sel(marker=name)
        found = acquire(pattern_of(str(one["kind"].values)), frame.image, one["image_position"].values, float(one["radius"]))
        sightings[name] = UNFOUND
        if found is not None:
            markers[name] = Marker(found)
            sightings[name] = markers[name].remember(frame, found)
    return sightings


def _dataset(times: Sequence[float], names: Sequence[str], film: Sequence[Sightings]) -> xr.Dataset:
    """All sightings as one Dataset."""
    rows = [[sightings.get(name, UNSHOWN) for name in names] for sightings in film]
    nowhere = np.full(2, np.nan)

    def table(value: Callable[[Fit], object], missing: object) -> list[list[object]]:
        return [[value(one) if isinstance(one, Fit) else missing for one in row] for row in rows]

    points, values = ("time", "marker", "image_axis"), ("time", "marker")
    return xr.Dataset(
        {
            "image_position": (points, table(lambda one: one.centre, nowhere), {"units": "pixel"}),
            "image_position_std": (points, table(lambda one: one.std, nowhere), {"units": "pixel"}),
            "quality": (values, table(lambda one: one.quality, 0.0), {"units": "1"}),
            "radius": (values, table(lambda one: one.radius, np.nan), {"units": "pixel"}),
            "lost": (values, [["" if isinstance(one, Fit) else one for one in row] for row in rows]),
        },
        {"time": ("time", list(times), {"units": "s"}), "marker": list(names), "image_axis": ["u", "v"]},
    )


def _check(frame: Frame) -> None:
    if frame.image.ndim != 2:
        raise CrashkitError(f"frame at {frame.time:g} s: expected a grey image (row, column), found shape {frame.image.shape}")


def _refuse_unfound(sightings: Sightings) -> None:
    lost = [name for name, found in sightings.items() if not isinstance(found, Fit)]
    if lost:
        raise CrashkitError(f"start: expected a target where {', '.join(lost)} was shown, found none")


def _refuse_unused(film: Sequence[Sightings], waiting: Sequence[xr.Dataset]) -> None:
    if not film:
        raise CrashkitError("film: expected at least one frame, found none")
    if waiting:
        raise CrashkitError(f"correction: expected the time of a frame, found {float(waiting[0]['time']):g} s")
