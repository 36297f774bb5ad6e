"""The contract of observers finds what it is there for."""

import pytest
from attrs import evolve

from crashkit.data.schema import GroupSchema
from crashkit.registry import load
from crashkit.testing import ObserverContract


def test_a_standard_deviation_that_may_be_0_is_found():
    film = load().observer("film")
    loose = tuple(evolve(variable, positive=False) for variable in film.schema.variables)
    lax = type("Lax", (film,), {"schema": GroupSchema("lax", loose)})
    ObserverContract().test_standard_deviations_are_above_0(film())
    with pytest.raises(AssertionError, match="^position_std: expected it declared with positive=True, as .*std_of does"):
        ObserverContract().test_standard_deviations_are_above_0(lax())
