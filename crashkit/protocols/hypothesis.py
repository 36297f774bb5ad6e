"""Hypothesis: one piece of physics that a model may have left out."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import field, frozen

from crashkit.model import Model


@frozen
class Proposal:
    """The physics at one place in one form: a model with it, and how to take it away again.

    Attributes:
        physics: its name.
        form: the functional form, for example "power".
        location: one of {"joint": ...}, {"body": ...}, {"bodies": [...]}, {"sensor": ..., "instrument": ...},
            {"instrument": ...}.
        model: the augmented model; its new parameters are free and stand at the first of `starts`.
        parameters: names (paths) of the new free parameters, the amplitude first.
        null: values of some of them at which the physics vanishes.
        starts: values of the new parameters to start a fit from, one mapping each.
        refined: whether it is a finer form of a claim that has simpler ones: it is only tried where these leave something, or
            where an unknown force would be told.
        odds: of this form beforehand, where several share the odds of one claim; above 1 where channels speak for it that no
            misfit holds.
        estimate_of: what a force of no known law, which is estimated, depends on: "deformation"; "distance" of a joint's ends,
            which also acts while they are apart; "rate", "time", "speed", "travel", or "deformation of another joint".
    """

    physics: str
    form: str
    location: Mapping[str, object]
    model: Model
    parameters: tuple[str, ...]
    null: Mapping[str, float]
    starts: tuple[Mapping[str, float], ...] = field(default=({},))
    refined: bool = field(default=False)
    odds: float = field(default=1.0)
    estimate_of: str = field(default="")


class Hypothesis(ABC):
    """Says where its physics could sit in a given model, and how the model looks with it.

    Attributes:
        physics: its name, from the list of DATA.md or a name of the plugin's own.
        sentence: what it means, for people; "{place}" stands for the place.
        sensor: True where an instrument is accused rather than the structure.
    """

    physics: ClassVar[str]
    sentence: ClassVar[str]
    sensor: ClassVar[bool] = False

    @abstractmethod
    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every place and form in which this physics could sit in `model`.

        Arguments:
            model: the model as re-identified.
            motion: its simulated motion, one for each recording: how far each joint was deformed, how fast.
            recordings: the recordings that it was fitted to.
        """
