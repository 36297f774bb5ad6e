"""What every question about a model needs."""

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
import xarray as xr
from attrs import field, frozen

from crashkit.diagnose.claims import Progress, identity, propose_all
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.from_given import FromGiven
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.reidentify import understood
from crashkit.diagnose.fitting.search import Search, weighed
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Proposal


@frozen
class Inquiry:
    """A model as it was given and as it fits best, and the means to ask what it leaves out.

    Attributes:
        workshop: the plugins to work with.
        given: the misfit of the model at the values that the user gave.
        base: the best fit of the model as it is.
        progress: told what is being done and how far it is (0 to 1).
        unthinned: the recordings as they are, by name, where what is found may outrun thinned ones; empty where it may not.
    """

    workshop: Workshop
    given: Misfit
    base: Search
    progress: Progress
    unthinned: Mapping[str, xr.DataTree] = field(factory=dict)

    @cached_property
    def from_given(self) -> FromGiven:
        """All claims from the values that the user gave, beside nothing."""
        return claims_from_given(self, self.base.fitted(), open_claims(self, self.base.fitted(), []))

    def fit_with(self, rivals: Sequence[Rival], last: Search) -> Search | None:
        """The fit of the model with these findings, from the values that they were last given; None if one has no place."""
        return rebuild(self.workshop, self.base, rivals, last)

    def again(self, rival: Rival) -> Search:
        """The model with a claim, re-identified from where the user gave its own numbers.

        Its fit began where the model without it had been driven, and may have stayed in that valley.
        """
        self.progress(f"re-identifying with {rival.proposal.physics}", 0.0)
        return weighed([understood(self.workshop, rival.search.fitted().with_values_of(self.given))])[0]


def open_claims(inquiry: Inquiry, current: Misfit, found: Sequence[Rival]) -> list[Proposal]:
    """Every hypothesis at every place of the given model, built on the current one, that has not been found already."""
    known = {rival.identity for rival in found}
    proposals, model = propose_all(inquiry.workshop, current), inquiry.given.model
    return [p for p in proposals if identity(p) not in known and is_given(model, p.location)]


def claims_from_given(inquiry: Inquiry, current: Misfit, proposals: Sequence[Proposal]) -> FromGiven:
    """The plain ones of these claims, built on a model, from the values that the user gave."""
    plain = [proposal for proposal in proposals if not proposal.refined]
    equipped = inquiry.workshop.equipped([proposal.model for proposal in plain])
    return FromGiven(equipped, current.with_values_of(inquiry.given), plain, inquiry.progress)


def is_given(model: Model, location: Mapping[str, object]) -> bool:
    """What a finding has added is not itself a place for further physics."""
    bodies, joints = {body.name for body in model.bodies}, {joint.name for joint in model.joints}
    named = {"joint": joints, "body": bodies, "bodies": bodies}
    return all(
        set(np.ravel(np.asarray(location[kind])).tolist()) <= known for kind, known in named.items() if kind in location
    )
