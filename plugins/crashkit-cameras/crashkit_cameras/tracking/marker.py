"""One marker on its way through a film."""

import numpy as np
from attrs import Factory, define, evolve, frozen

from crashkit_cameras.tracking.detect import settle
from crashkit_cameras.tracking.fit import Fit, fit
from crashkit_cameras.tracking.frame import Frame
from crashkit_cameras.tracking.light import Light
from crashkit_cameras.tracking.path import Path
from crashkit_cameras.tracking.search import search_around

UNLIKE = "nothing like it where it is expected"
UNCERTAIN = "too uncertain: blurred or faint"
OUTSIDE = "outside the image"
MOST_TRIED = 5
"""Places that are tried for a target that is not where it is expected."""
FOLLOWED, AGAIN = 4.0, 1.4
"""By how much size and contrast may differ from when the target was last seen: while it is followed, and when found again."""
LESS_CERTAIN = 4.0
"""By how much the standard deviation of a target that is found again may exceed the last one."""
WIDER = 0.25
"""By how much wider a target is looked for with each frame that it was not seen."""
GROWTH = 1.1
"""How much larger or smaller a target may become from one frame to the next."""
STRAYED = 0.7
"""Radii; a fit that ends further from its start has found something else."""
WHOLE = 0.9
"""The part of its quality from which on a target is remembered as it looks: less means that something is in front of it."""


@frozen
class Limits:
    """When a target counts as seen.

    Arguments:
        quality: the least share of the image around it that the pattern explains.
        std: the largest standard deviation of u and of v, pixel.
        search: how far from its expected place it is looked for, in radii; a quarter more for each frame that it was lost.
    """

    quality: float = 0.6
    std: float = 0.2
    search: float = 3.0


@define
class Marker:
    """A target that is being followed.

    Attributes:
        seen: how it looked when it was seen last.
        path: where it was.
        light: that fell on it.
        missed: frames since it was seen.
    """

    seen: Fit
    path: Path = Factory(Path)
    light: Light = Factory(Light)
    missed: int = 0

    @property
    def radius(self) -> float:
        """Of its disc when it was seen last, pixel."""
        return self.seen.radius

    def here(self, frame: Frame, limits: Limits) -> Fit | str:
        """The target at its expected place, or why it is not seen there."""
        expected = self.path.expected(frame.time)
        found = fit(self.seen.pattern, frame.image, self._shape(expected))
        if found is None or np.hypot(*(found.centre - expected)) > STRAYED * self.radius:
            return UNLIKE
        return self._judged(found, limits) if self.missed == 0 else self._recognised(found, limits)

    def around(self, frame: Frame, limits: Limits, taken: list[np.ndarray]) -> Fit | str:
        """The target somewhere around its expected place, away from places that are taken, or why it is not seen."""
        expected, pattern = self.path.expected(frame.time), self.seen.pattern
        reason = UNLIKE if self._whole(frame.image, expected) else OUTSIDE
        within = limits.search * self.radius * (1.0 + WIDER * self.missed)
        candidates = search_around(pattern, frame.image, [self.radius], expected, within)
        free = [one for one in candidates if all(np.hypot(*(one.centre - place)) > self.radius for place in taken)]
        for candidate in free[:MOST_TRIED]:
            for shape in (self._shape(candidate.centre), candidate.shape(pattern)):
                found = settle(pattern, frame.image, shape)
                judged = UNLIKE if found is None else self._recognised(found, limits)
                if isinstance(judged, Fit):
                    return judged
        return reason

    def remember(self, frame: Frame, found: Fit | str) -> Fit | str:
        """Remember where and how the target was seen, or that it was not; return it as it is in the remembered light."""
        if not isinstance(found, Fit):
            self.missed, self.light = self.missed + 1, Light()
            return found
        found = self.light.applied(found)
        self.missed = 0
        self.path.add(frame.time, found.centre)
        if found.quality > WHOLE * self.seen.quality:
            self.seen = _measured(found, frame.image)
        return found

    def _shape(self, centre: np.ndarray) -> np.ndarray:
        """The target as it was seen last, at another place."""
        return np.append(centre, self.seen.shape[2:])

    def _judged(self, found: Fit, limits: Limits, likeness: float = FOLLOWED) -> Fit | str:
        """A fit if it is good enough and the target's like, or why it is not."""
        ratios = np.array([found.radius / self.radius, found.contrast / self.seen.contrast])
        if found.quality < limits.quality or np.any(ratios < 1.0 / likeness) or np.any(ratios > likeness):
            return UNLIKE
        return UNCERTAIN if np.max(found.std) > limits.std else found

    def _recognised(self, found: Fit, limits: Limits) -> Fit | str:
        """The same for a target that was lost: something else could look similar, but hardly be as sharp."""
        std = min(limits.std, LESS_CERTAIN * np.max(self.seen.std))
        quality = max(limits.quality, WHOLE * self.seen.quality)
        return self._judged(found, evolve(limits, std=std, quality=quality), AGAIN)

    def _whole(self, image: np.ndarray, centre: np.ndarray) -> bool:
        """Whether a target there would be whole in the image."""
        return bool(np.all(centre >= self.radius) and np.all(centre <= np.array(image.shape[::-1]) - 1 - self.radius))


def _measured(found: Fit, image: np.ndarray) -> Fit:
    """A target with its size taken from the image, within what a size may change."""
    shape, fitted = found.shape.copy(), found.pattern.fitted
    measured = found.pattern.measured(shape, image)[fitted:]
    shape[fitted:] = measured.clip(shape[fitted:] / GROWTH, shape[fitted:] * GROWTH)
    return evolve(found, shape=shape)
