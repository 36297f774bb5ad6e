"""An effect: one secret at one place, with a strength that can be turned up and down."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from attrs import field, frozen

from crashkit.testing.concealed.kinds import Kind
from crashkit.testing.concealed.scene import Scene
from crashkit.testing.concealed.world import Joint, Motion, Term

Answer = tuple[str, str | None, Any]
"""Physics, kind of place ("joint", "body", "bodies", "sensor", "instrument") and place."""


@frozen
class Effect:
    """One secret.

    Arguments:
        physics: the name that a diagnosis should give it.
        form: the functional form.
        kind, place: where it sits.
        numbers: at strength 1, for whoever opens the seal.
        conceal: puts it into a scene at a strength.
        limits: of the strength.
        rivals: other answers that are as right.
    """

    physics: str
    form: str
    kind: str
    place: Any
    numbers: Mapping[str, Any]
    conceal: Callable[[Scene, float], None]
    limits: tuple[float, float] = (0.02, 4.0)
    rivals: tuple[Answer, ...] = field(default=())

    def into(self, scene: Scene, strength: float) -> Scene:
        """The scene with this secret in it."""
        scene = scene.copy()
        self.conceal(scene, strength)
        return scene

    def answers(self) -> list[Answer]:
        """Every right answer."""
        return [(self.physics, self.kind, self.place), *self.rivals]


Maker = Callable[["Stage"], Effect | None]
"""Draws an effect for a vehicle; None where that vehicle cannot have it."""


@frozen
class Stage:
    """What an effect is drawn for: a vehicle, its motion without secrets, and chance; whether its form is the plainest."""

    scene: Scene
    motions: list[Motion]
    rng: np.random.Generator
    plain: bool = False

    def among(self, low: float, high: float) -> float:
        """A number between two."""
        return float(self.rng.uniform(low, high))

    def one_of(self, *choices: str) -> str:
        """One of some names."""
        return str(self.rng.choice(choices))

    def form(self, plainest: str, *others: str) -> str:
        """One of an effect's forms."""
        return plainest if self.plain else self.one_of(plainest, *others)

    def joint(self) -> str:
        """A joint of the given model."""
        return self.one_of(*self.scene.public)

    def is_mount(self, joint: str) -> bool:
        """Whether a joint holds two moving bodies together."""
        return self.scene.world.joints[joint].front != self.scene.obstacle

    def deepest(self, joint: str) -> float:
        """m, largest deformation in the fastest of the runs that are fitted."""
        return float(self.motions[-1].deformation[joint].max())

    def fastest(self, joint: str) -> float:
        """m s-1, largest deformation rate there."""
        motion = self.motions[-1]
        return float(np.gradient(motion.deformation[joint], motion.time).max())

    def true(self, joint: str) -> Joint:
        """A joint as it is, without the secret."""
        return self.scene.world.joints[joint]


def one_term(
    physics: str, form: str, joint: str, kind: Kind, numbers: tuple[float, ...], limits: tuple[float, float] = (0.02, 4.0)
) -> Effect:
    """A secret of a joint that is one term of its force; the strength multiplies the term's first number."""

    def conceal(scene: Scene, strength: float) -> None:
        scene.world.joints[joint].terms.append(Term(kind, (numbers[0] * strength, *numbers[1:])))

    return Effect(physics, form, "joint", joint, {kind.name.lower(): list(numbers)}, conceal, limits)
