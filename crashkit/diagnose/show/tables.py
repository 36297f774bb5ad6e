"""The tables and curves behind a diagnosis."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from crashkit.campaign import spread
from crashkit.diagnose.claims import identity
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import own_name, place_of
from crashkit.diagnose.show.left_out import left_out_sum
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Group, Misfit
from crashkit.misfit.units import units_of
from crashkit.protocols import Identification, Identifier, Proposal

LEADING = 3
"""Rivals of each look that are also asked for runs that they have not seen."""


def ranking_table(discovery: Discovery) -> xr.Dataset:
    """Every rival that was fitted, look by look; the first few also with how they predict runs that are left out."""
    looks = [*discovery.findings, *([discovery.last] if discovery.last else [])]
    predicted = _left_out_drops(discovery.search.identifier, looks)
    rows = [
        (
            r.proposal.physics,
            r.proposal.form,
            r.place,
            number + 1,
            len(r.proposal.parameters),
            r.drop,
            p,
            predicted.get((number, r.identity), np.nan),
        )
        for number, look in enumerate(looks)
        for r, p in zip(look.rivals, look.probabilities, strict=True)
    ]
    names = ("physics", "form", "place", "round", "parameters", "misfit_drop", "probability", "left_out_drop")
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(names)
    return xr.Dataset({name: ("hypothesis", np.array(column)) for name, column in zip(names, columns, strict=True)})


def _left_out_drops(identifier: Identifier[Any], looks: Sequence[Look]) -> dict[tuple[int, tuple[str, str]], float]:
    """By look and claim, of the first few of each, how much better runs that are left out are predicted with it."""
    asked: dict[tuple[int, tuple[str, str] | None], Misfit] = {
        (number, None): look.before for number, look in enumerate(looks) if look.rivals
    }
    asked |= {(number, r.identity): r.search.fitted() for number, look in enumerate(looks) for r in look.rivals[:LEADING]}
    sums = dict(zip(asked, spread(partial(left_out_sum, identifier), list(asked.values())), strict=True))
    return {(number, claim): sums[number, None] - left for (number, claim), left in sums.items() if claim is not None}


def limits_table(workshop: Workshop, discovery: Discovery) -> xr.Dataset:
    """Of every claim that was not made, the smallest effect that the recordings would have shown."""
    told = {look.leader.identity for look in discovery.findings}
    limits = [one for one in (discovery.last.limits if discovery.last else ()) if np.isfinite(one.smallest)]
    limits = [one for one in limits if identity(one.proposal) not in told]
    rows = [_limit_row(workshop, discovery.final.groups, one.proposal, one.smallest) for one in limits]
    names = ("physics", "form", "place", "parameter", "smallest", "units")
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(names)
    return xr.Dataset({name: ("effect", np.array(column)) for name, column in zip(names, columns, strict=True)})


def _limit_row(
    workshop: Workshop, groups: Sequence[Group], proposal: Proposal, smallest: float
) -> tuple[str, str, str, str, float, str]:
    path = proposal.parameters[0]
    unit = units_of(proposal.model, workshop.laws, groups).get(path, "")
    return proposal.physics, proposal.form, place_of(proposal.location), own_name(path), smallest, unit


def identified_table(discovery: Discovery, result: Identification) -> xr.Dataset:
    """The parameters of the final model, beside those of the re-identified one."""
    table = result.parameters
    names = [str(name) for name in table["parameter"].values]
    before = {name: p.value for name, p in discovery.base.model.free_parameters().items()}
    earlier = np.array([before.get(name, np.nan) for name in names])
    return table[["value", "std", "units", "identifiable"]].assign(before=("parameter", earlier))
