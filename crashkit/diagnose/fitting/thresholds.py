"""A threshold that no run reaches where a search ends has no derivative there, and stays: begun again where it is reached."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from crashkit.diagnose.fitting.regress import residual_and_jacobian
from crashkit.diagnose.fitting.search import Search, begin, begun_again
from crashkit.diagnose.workshop import Workshop
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.model import Model

REACHED = ({"deformation": 0.9, "force": 0.8}, {"deformation": 0.7, "force": 0.6}, {"deformation": 0.5, "force": 0.4})
"""Of the largest that its joint comes to: where a threshold is begun again. Of a joint that was elastic throughout, a force
and a deformation at the same share are reached at one instant, and then one of the two has no derivative."""
PLAINLY = 1e-3
"""Share by which a threshold must lower what is left for others to be begun again from there: some end a little lower every
time, without end."""
OF = {"m": "deformation", "N": "force"}
"""What a threshold with these units is one of."""


def wakened(workshop: Workshop, search: Search) -> Search:
    """The fit, or a better one that reaches thresholds which it does not reach.

    As densification behind all that a joint comes to, or a plateau above all that it bears: some claim would stand in for it.
    """
    if not math.isfinite(search.state.cost):
        return search
    best = begun_again(search, _lower(workshop, search))
    is_plain = best.state.cost < (1.0 - PLAINLY) * search.state.cost
    return wakened(workshop, best) if is_plain else best


def awake(workshop: Workshop, given: Misfit, fitted: Search) -> Misfit:
    """The given values, but a fit's of thresholds that it reaches, and they do not, simulated or as it was measured.

    Where such a threshold was given, either simulations or the equations of motion do not tell which way it is wrong.
    """
    places, known = _places(workshop, given.model), fitted.values
    equations = residual_and_jacobian(workshop, given)
    asleep = set(_idle(given, equations[1])) if equations else set()
    try:
        asleep = asleep.union(_asleep(begin(fitted.identifier, given))).difference(_asleep(fitted))
    except SimulationError:
        return given
    return given.with_values({path: known[path] for path in asleep if path in places})


def _lower(workshop: Workshop, search: Search) -> Iterator[dict[str, float]]:
    """Values, in SI units, of the lengths and forces in laws that nothing depends on, at which something would: each alone,
    and all together."""
    values, places = search.values, _places(workshop, search.misfit.model)
    asleep = [path for path in _asleep(search) if path in places]
    largest = _largest(search) if asleep else {}
    for share in REACHED:
        begun = {path: share[places[path][1]] * largest[places[path]] for path in asleep}
        lower = {path: value for path, value in begun.items() if 0.0 < value < values[path]}
        yield from ({path: value} for path, value in lower.items())
        if len(lower) > 1:
            yield lower


def _asleep(search: Search) -> list[str]:
    """The numbers that no sample depends on."""
    misfit = search.misfit
    return _idle(misfit, misfit.residual_and_jacobian(search.point)[1][: misfit.sample_count])


def _idle(misfit: Misfit, jacobian: np.ndarray) -> list[str]:
    """The numbers of columns that are nothing."""
    return [name for name, column in zip(misfit.names, jacobian.T, strict=True) if not column.any()]


def _places(workshop: Workshop, model: Model) -> Mapping[str, tuple[str, str]]:
    """The joint of each length and force in a law, and what they are one of, by path."""
    specs = [(joint.name, spec) for joint in model.joints for spec in workshop.laws[joint.law].parameters]
    return {f"joint.{joint}.{spec.name}": (joint, OF[spec.unit]) for joint, spec in specs if spec.unit in OF}


def _largest(search: Search) -> dict[tuple[str, str], float]:
    """The largest deformation, m, and force, N, of each joint in any run."""
    misfit, values = search.misfit, search.values
    motions = [misfit.predictor.motion(run, values) for run in misfit.recordings]
    joints = motions[0]["joint"].values.tolist()
    return {(j, name): max(float(run[name].sel(joint=j).max()) for run in motions) for j in joints for name in OF.values()}
