"""A vehicle before a set of tests: what it is, what watches it, how fast it arrives."""

import copy

import numpy as np
from attrs import define

from crashkit.testing.concealed.instruments import MARGIN, Instrument, read
from crashkit.testing.concealed.world import STEP, Motion, World, run

TAIL = MARGIN + 0.015
"""s followed beyond the recording, for filters and clocks."""


@define
class Scene:
    """A vehicle before a set of tests, with every secret that was put into it.

    Arguments:
        obstacle: name of the body that is hit.
        bodies: names of the moving bodies that the given model has.
        world: bodies and joints as they really are.
        instruments: by the name of their group.
        speeds: m s-1 of the runs, the held-out one last.
        duration: s.
    """

    obstacle: str
    bodies: list[str]
    world: World
    instruments: dict[str, Instrument]
    speeds: list[float]
    duration: float

    def copy(self) -> "Scene":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)

    @property
    def public(self) -> list[str]:
        """Names of the joints that the given model has."""
        return [name for name, joint in self.world.joints.items() if joint.law]

    def motions(self, runs: slice = slice(0, -1), step: float = STEP) -> list[Motion]:
        """What happens in some of the runs; by default in those that are fitted."""
        return [run(self.world, speed, self.duration + TAIL, step) for speed in self.speeds[runs]]

    def signals(self, motions: list[Motion]) -> np.ndarray:
        """Every sample without noise, in units of the noise before the filter.

        A filter passes the same share of a slow signal's and of the noise's independent samples, so a sum of squares of
        these counts independent samples only.
        """
        columns = [
            read(instrument, sensor, motion, self.duration, None) / sensor.noise
            for motion in motions
            for instrument in self.instruments.values()
            for sensor in instrument.sensors.values()
        ]
        return np.concatenate(columns)
