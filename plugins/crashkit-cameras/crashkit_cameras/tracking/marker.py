"""One marker on its way through a film."""

import numpy as np
from attrs import Factory, define, evolve, frozen

from crashkit_cameras.tracking.detect import settle
from crashkit_cameras.tracking.fit import Fit, fit
from crashkit_cameras.tracking.frame import Frame
from crashkit_cameras.tracking.path import Path
from crashkit_cameras.tracking.search import search_around

UNLIKE = "nothing like it where it is expected"
UNCERTAIN = "too uncertain: blurred or faint"
OUTSIDE = "outside the image"
MOST_TRIED = 5
FOLLOWED, AGAIN = 4.0, 1.6
"""By how much size and contrast may differ from when the target was last seen: where it is expected, and where it is found again."""
LESS_CERTAIN = 4.0
"""By how much the standard deviation of a target that is found again may exceed the last one."""
GROWTH = 1.1
"""How much larger or smaller a target may become from one frame to the next."""
STRAYED = 0.7
"""Radii; a fit that ends further from its start has found something else."""
WHOLE = 0.9
"""The quality from which a target's size is trusted: nothing is in front of it."""


@frozen
class Limits:
    """When a target counts as seen.

    Arguments:
        quality: the least share of the image around it that the pattern explains.
        std: the largest standard deviation of u and v, pixel.
        search: how far from its expected place it is looked for, in radii; as far again for each frame that it was lost.
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
        missed: frames since it was seen.
    """

    seen: Fit
    path: Path = Factory(Path)
    missed: int = 0

    @property
    def radius(self) -> float:
        """Of its disc when it was seen last, pixel."""
        return self.seen.radius

    def here(self, frame: Frame, limits: Limits) -> Fit | str:
        """The target at its expected place, or why it is not seen there."""
        return self._judged(self._fitted(frame.image, self.path.expected(frame.time)), limits, FOLLOWED)

    def around(self, frame: Frame, limits: Limits, taken: list[np.ndarray]) -> Fit | str:
        """The target somewhere around its expected place, away from places that are taken, or why it is not seen."""
        expected = self.path.expected(frame.time)
        again = evolve(limits, std=min(limits.std, LESS_CERTAIN * np.max(self.seen.std)))
        within = limits.search * self.radius * (1 + self.missed)
        reason = UNLIKE if self._whole(frame.image, expected) else OUTSIDE
        candidates = search_around(self.seen.pattern, frame.image, [self.radius], expected, within)
        free = [one for one in candidates if all(np.hypot(*(one.centre - place)) > self.radius for place in taken)]
        for candidate in free[:MOST_TRIED]:
            for found in (self._fitted(frame.image, candidate.centre), settle(self.seen.pattern, frame.image, candidate)):
                judged = self._judged(found, again, AGAIN)
                if isinstance(judged, Fit):
                    return judged
        return reason

    def remember(self, frame: Frame, found: Fit | str) -> None:
        """Where and how the target was seen, or that it was not."""
        if not isinstance(found, Fit):
            self.missed += 1
            return
        self.missed = 0
        self.path.add(frame.time, found.centre)
        self.seen = _measured(found, frame.image) if found.quality > WHOLE else found

    def _fitted(self, image: np.ndarray, centre: np.ndarray) -> Fit | None:
        """The target as it looked last, fitted around a place."""
        shape = self.seen.shape.copy()
        shape[:2] = centre
        found = fit(self.seen.pattern, image, shape)
        strayed = found is not None and np.hypot(*(found.centre - centre)) > STRAYED * self.radius
        return None if strayed else found

    def _judged(self, found: Fit | None, limits: Limits, likeness: float) -> Fit | str:
        """A fit if it is the target, as much alike as `likeness` asks, or why it is not."""
        if found is None or found.quality < limits.quality:
            return UNLIKE
        ratios = np.array([found.radius / self.radius, found.contrast / self.seen.contrast])
        if np.any(ratios < 1.0 / likeness) or np.any(ratios > likeness):
            return UNLIKE
        return UNCERTAIN if np.max(found.std) > limits.std else found

    def _whole(self, image: np.ndarray, centre: np.ndarray) -> bool:
        """Whether a target there would be whole in the image."""
        return bool(np.all(centre >= self.radius) and np.all(centre <= np.array(image.shape[::-1]) - 1 - self.radius))


def _measured(found: Fit, image: np.ndarray) -> Fit:
    """A target with its size taken from the image, within what a size may change."""
    shape, fitted = found.shape.copy(), found.pattern.fitted
    measured = found.pattern.measured(shape, image)[fitted:]
    shape[fitted:] = measured.clip(shape[fitted:] / GROWTH, shape[fitted:] * GROWTH)
    return evolve(found, shape=shape)
