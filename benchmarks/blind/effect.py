"""An effect: one secret at one place, with a strength that can be turned up and down."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from attrs import field, frozen

from benchmarks.blind.forces import Kind
from benchmarks.blind.vehicle import Scene
from benchmarks.blind.world import Link, Term, Trace

Answer = tuple[str, str | None, Any]
"""Physics, kind of place ("joint", "body", "bodies", "sensor", "instrument") and place."""


@frozen
class Effect:
    """One secret.

    Arguments:
        physics: its name in the list of the data contract.
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
    """What an effect is drawn for: a vehicle, its motion without secrets, and chance."""

    scene: Scene
    traces: list[Trace]
    rng: np.random.Generator

    def among(self, low: float, high: float) -> float:
        """A number between two."""
        return float(self.rng.uniform(low, high))

    def one_of(self, *choices: str) -> str:
        """One of some names."""
        return str(self.rng.choice(choices))

    def link(self) -> str:
        """A link of the public model."""
        return self.one_of(*self.scene.public)

    def is_mount(self, link: str) -> bool:
        """Whether a link holds two moving bodies together."""
        return self.scene.world.links[link].front != self.scene.obstacle

    def deepest(self, link: str) -> float:
        """m, largest deformation in the fastest of the runs that are fitted."""
        return float(self.traces[-1].deformation[link].max())

    def fastest(self, link: str) -> float:
        """m s-1, largest deformation rate there."""
        trace = self.traces[-1]
        return float(np.gradient(trace.deformation[link], trace.time).max())

    def acting(self, link: str) -> Link:
        """A link as it is."""
        return self.scene.world.links[link]


def term(
    physics: str, form: str, link: str, kind: Kind, numbers: tuple[float, ...], limits: tuple[float, float] = (0.02, 4.0)
) -> Effect:
    """A secret of a link that is one term of its force; the strength multiplies the term's first number."""

    def conceal(scene: Scene, strength: float) -> None:
        scene.world.links[link].terms.append(Term(kind, (numbers[0] * strength, *numbers[1:])))

    return Effect(physics, form, "joint", link, {kind.name.lower(): list(numbers)}, conceal, limits)
