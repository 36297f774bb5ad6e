"""Numbers of a list that must increase keep their order in a search."""

from collections.abc import Iterator, Sequence

from attrs import evolve

from crashkit.model import Model, Parameter

REACH = 0.45
"""Share of the way to a neighbour that a number may go: two that went half of it would meet."""


def kept_apart(model: Model, lists: Sequence[Sequence[str]]) -> dict[str, Parameter]:
    """The free parameters by path, where those of an increasing list go not quite half way to their neighbours.

    Arguments:
        lists: paths of the numbers of each list.
    """
    free, known = model.free_parameters(), model.parameters()
    moving = [paths for paths in lists if not free.keys().isdisjoint(paths)]
    narrow = (one for paths in moving for one in _narrowed({path: known[path] for path in paths}))
    return free | {path: parameter for path, parameter in narrow if path in free}


def _narrowed(numbers: dict[str, Parameter]) -> Iterator[tuple[str, Parameter]]:
    values = [0.0, *(parameter.value for parameter in numbers.values()), float("inf")]
    neighbours = zip(values, values[2:], strict=False)
    for (path, parameter), (below, above) in zip(numbers.items(), neighbours, strict=True):
        lower, upper = (parameter.value + REACH * (other - parameter.value) for other in (below, above))
        yield path, evolve(parameter, lower=max(parameter.lower, lower), upper=min(parameter.upper, upper))
