"""A search ends where a further step is not worth its time."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose.fitting.search import Search
from crashkit.protocols import Status

SAMPLES = 1000.0


def stepping(costs):
    """A search whose cost goes from the first of these to the next with each step."""

    def step(misfit, state):
        after = costs[costs.index(state.cost) + 1]
        return SimpleNamespace(cost=after, status=Status.RUNNING)

    first = SimpleNamespace(cost=costs[0], status=Status.RUNNING)
    return Search(SimpleNamespace(step=step), SimpleNamespace(independent_samples=SAMPLES), first)


@pytest.mark.parametrize(
    ("costs", "end"),
    [
        ([9e5, 8e5, 7.9999e5, 7.9998e5, 1e5], 7.9998e5),
        ([9e5, 8e5, 7.9999e5, 7e5, 6.9999e5, 1e5], 1e5),
        ([9e5, 8e5, 7.9e5, 1e5], 1e5),
        ([501.0, 500.5, 500.4, 500.39, 300.0], 500.39),
        ([501.0, 500.5, 500.4, 500.2, 300.0], 300.0),
    ],
)
def test_a_fit_far_above_the_noise_ends_where_it_creeps_and_one_near_it_at_next_to_nothing(costs, end):
    search = stepping(costs).advance(len(costs) - 1)
    assert search.state.cost == end
    assert search.settled is (end != costs[-1])
