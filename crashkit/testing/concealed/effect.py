"""An effect: one secret at one place, with a strength that can be turned up and down."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from attrs import field, frozen

from crashkit.testing.concealed.vehicle import Scene
from crashkit.testing.concealed.world import Trace

Answer = tuple[str, str | None, Any]
"""Physics, kind of place ("joint", "body", "bodies", "sensor", "instrument") and place."""


@frozen
class Effect:
    """One secret.

    Arguments:
        physics: its name in the list of the data contract.
        form: the functional form.
        kind, place: where it sits.
        fields: its numbers at strength 1.
        change: puts numbers into a scene.
        scaled: those of the fields that the strength multiplies.
        limits: of the strength.
        rivals: other answers that are as right.
    """

    physics: str
    form: str
    kind: str
    place: Any
    fields: Mapping[str, float]
    change: Callable[[Scene, Mapping[str, float]], None]
    scaled: tuple[str, ...]
    limits: tuple[float, float] = (0.02, 4.0)
    rivals: tuple[Answer, ...] = field(default=())

    def numbers(self, strength: float) -> dict[str, float]:
        """The numbers at a strength."""
        return {name: float(value * strength if name in self.scaled else value) for name, value in self.fields.items()}

    def into(self, scene: Scene, strength: float) -> Scene:
        """The scene with this secret in it."""
        scene = scene.copy()
        self.change(scene, self.numbers(strength))
        return scene

    def answers(self) -> list[Answer]:
        """Every right answer."""
        return [(self.physics, self.kind, self.place), *self.rivals]


@frozen
class Stage:
    """What an effect is drawn for: a vehicle, its true motion without secrets, and chance."""

    scene: Scene
    traces: list[Trace]
    rng: np.random.Generator

    def one_of(self, choices: list[str] | tuple[str, ...]) -> str:
        """A random one of some names."""
        return str(self.rng.choice(list(choices)))

    def joint(self) -> str:
        """A random joint of the public model."""
        return self.one_of(self.scene.public_joints)

    def is_mount(self, joint: str) -> bool:
        """Whether a joint holds two moving bodies together."""
        return self.scene.world.joints[joint].front != self.scene.obstacle

    def deepest(self, joint: str) -> float:
        """Largest deformation in the fastest calibration run, m."""
        return float(self.traces[2].deformation[joint].max())

    def fastest(self, joint: str) -> float:
        """Largest deformation rate in the fastest calibration run, m s-1."""
        return float(np.gradient(self.traces[2].deformation[joint], self.traces[2].time).max())

    def field(self, joint: str, name: str) -> float:
        """A true number of a joint."""
        return self.scene.world.joints[joint].fields[name]

    def elastic_limit(self, joint: str) -> float:
        """Deformation at which the plateau begins, m."""
        return self.field(joint, "crush_force") / self.field(joint, "elastic_stiffness")
