"""What a hypothesis proposes, where that can be worked with: nothing that one does wrong stops the others."""

from collections.abc import Iterable, Sequence

import xarray as xr

from crashkit.data.validate import names
from crashkit.errors import CrashkitError, one_line
from crashkit.model import Model
from crashkit.model.checks import model_faults
from crashkit.protocols import Hypothesis, Laws, Proposal


def proposed_by(
    kind: type[Hypothesis], model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]
) -> list[Proposal]:
    """What a hypothesis proposes; raises CrashkitError, which says what it does wrong."""
    try:
        found = kind().propose(model, motion, recordings)
        proposals = list(found) if isinstance(found, Iterable) else None
    except Exception as error:  # whatever a plugin raises
        raise CrashkitError(f"propose raised {one_line(error)}") from error
    if proposals is None:
        raise CrashkitError(f"propose: expected a list of proposals, found {found!r}")
    for proposal in proposals:
        _check(proposal, kind.physics)
    return proposals


def check_models(proposals: Iterable[Proposal], model: Model, laws: Laws) -> None:
    """Refuse proposals whose models have faults that the model they came from has not: raises CrashkitError."""
    own = model_faults(model, laws)
    for proposal in proposals:
        fault = next((fault for fault in model_faults(proposal.model, laws) if fault not in own), None)
        if fault is not None:
            raise CrashkitError(f"a proposal ({proposal.form}): {fault}")


def _check(proposal: Proposal, physics: str) -> None:
    if not isinstance(proposal, Proposal) or not isinstance(proposal.model, Model):
        raise CrashkitError(f"propose: expected proposals of models, found {type(proposal).__name__}")
    if proposal.physics != physics:
        raise CrashkitError(f'propose: expected proposals of "{physics}", found one of "{proposal.physics}"')
    known = proposal.model.parameters()
    also = [*proposal.null, *(path for start in proposal.starts for path in start)]
    strangers = [path for path in proposal.parameters if path not in known or known[path].fixed]
    strangers += [path for path in also if path not in known]
    if strangers:
        expected = "parameters of its model, and those that are new free"
        raise CrashkitError(f"a proposal ({proposal.form}): expected {expected}, found {names(strangers)}")
