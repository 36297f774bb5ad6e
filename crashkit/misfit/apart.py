"""Numbers of a list that must increase keep their order in a search."""

from collections.abc import Iterator, Sequence

from attrs import evolve

from crashkit.model import Model, Parameter


def kept_apart(model: Model, lists: Sequence[Sequence[str]]) -> dict[str, Parameter]:
    """The free parameters by path, where those of an increasing list go no further than half way to their neighbours.

    Arguments:
        lists: paths of the numbers of each list.
    """
    free, known = model.free_parameters(), model.parameters()
    moving = [paths for paths in lists if not free.keys().isdisjoint(paths)]
    narrow = (one for paths in moving for one in _narrowed({path: known[path] for path in paths}))
    return free | {path: parameter for path, parameter in narrow if path in free}


def _narrowed(numbers: dict[str, Parameter]) -> Iterator[tuple[str, Parameter]]:
    values = [parameter.value for parameter in numbers.values()]
    middles = [0.5 * (low + high) for low, high in zip([0.0, *values[:-1]], values, strict=True)]
    for (path, parameter), lower, upper in zip(numbers.items(), middles, [*middles[1:], float("inf")], strict=True):
        yield path, evolve(parameter, lower=max(parameter.lower, lower), upper=min(parameter.upper, upper))
