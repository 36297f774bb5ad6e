"""What the paper did not try: starts far off, noise, faster tests, structures that are changed afterwards."""

from collections.abc import Callable

import numpy as np
from attrs import frozen

from benchmarks.identification import searched
from benchmarks.paper.cases import predicted
from benchmarks.paper.tables import PATIENCE
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_identifiers.multi_start import MultiStart
from crashkit_identifiers.run import run

NINE = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
TOYS = {"one degree": toys.one_degree(), "two degrees": NINE}
NOISES = (0.01, 0.03, 0.1)
DRAWS, TESTS = 12, 4
"""Repeated tests, for the scatter and for predictions."""
FASTER = (1.5, 2.0)


QUICK = ("multi_start", "sensitivity", "optimal_control")
"""Methods that get all starts; the others take ten to a hundred times as long and get some."""
Draw = Callable[[np.random.Generator, int], np.ndarray]
KINDS: dict[str, Draw] = {
    "within 50 %": lambda random, n: random.uniform(0.5, 1.5, n),
    "50 % too large or small": lambda random, n: random.choice([0.5, 1.5], n),
    "three times too large or small": lambda random, n: 3.0 ** random.choice([-1, 1], n),
}


@frozen(eq=False)
class Share:
    """How far a method gets: the largest relative error of a parameter, from each of several random starts."""

    toy: str
    start: str
    method: str
    errors: np.ndarray

    def rate(self, limit: float) -> float:
        """Share of the starts from which all parameters were found."""
        return float(np.mean(self.errors < limit))


def far_starts(count: int, fewer: int) -> list[Share]:
    """Every method from random starts; the quick ones from `count`, the others from `fewer` of the same."""
    return [
        Share(toy, kind, method, _errors(truth, method, draw, count if method in QUICK else fewer))
        for toy, truth in TOYS.items()
        for kind, draw in KINDS.items()
        for method in load().identifiers
    ]


def noise_table() -> str:
    """Scatter and bias of repeated tests against the Cramér-Rao bound."""
    head = "| | noise | scatter over the bound, worst parameter | bias over the scatter of a mean, worst | inside 95 % |"
    rows = [_noisy(toy, truth, noise) for toy, truth in TOYS.items() for noise in NOISES]
    return "\n".join([head, "|" + " --- |" * 5, *rows])


def prediction_table() -> str:
    """Relative error of the accelerations at higher speeds, identified at one speed and at two."""
    head = "| | identified at | noise | speed 1.5 | speed 2 |"
    rows = []
    for toy, truth in (*TOYS.items(), ("two degrees, as printed", toys.two_degrees())):
        for speeds in ((1.0,), (1.0, 1.5)):
            for noise in (0.0, *NOISES):
                models = [_identified(truth, speeds, noise, seed) for seed in range(TESTS if noise else 1)]
                errors = [np.sqrt(np.mean([relative(m, truth, speed) ** 2 for m in models])) for speed in FASTER]
                where = " and ".join(f"{speed:g}" for speed in speeds)
                rows.append(f"| {toy} | {where} | {100 * noise:g} % | " + " | ".join(f"{e:.1e}" for e in errors) + " |")
    return "\n".join([head, "|" + " --- |" * 5, *rows])


def structures_table() -> str:
    """Does a model that was identified with 3 % of noise predict a structure that was changed afterwards?"""
    changes = {
        "as it was": {},
        "rear mass 20 % larger": {"body.rear.mass": 1.2},
        "first spring 30 % stronger": {"joint.first.crush_force": 1.3, "joint.first.elastic_stiffness": 1.3},
        "second plateau 30 % lower": {"joint.second.crush_force": 0.7},
        "first spring densifies 20 % earlier": {"joint.first.densification_deformation": 0.8},
    }
    models = {noise: _identified(NINE, (1.0,), noise) for noise in (0.0, 0.03)}
    head = "| changed afterwards | change of the motion | error, no noise | error, 3 % |"
    rows = []
    for name, factors in changes.items():
        truth = _changed(NINE, factors)
        errors = [relative(_changed(model, factors), truth, 1.0) for model in models.values()]
        rows.append(f"| {name} | {relative(truth, NINE, 1.0):.2g} | " + " | ".join(f"{e:.1e}" for e in errors) + " |")
    return "\n".join([head, "|" + " --- |" * 4, *rows])


def relative(model: Model, truth: Model, speed: float) -> float:
    """Root mean square error of the accelerations at a speed, as a share of theirs."""
    wanted = predicted(truth, speed)
    return float(np.linalg.norm(predicted(model, speed) - wanted) / np.linalg.norm(wanted))


def _errors(truth: Model, method: str, draw: Draw, count: int) -> np.ndarray:
    misfit, random = _misfit(truth, (1.0,), 0.0), np.random.default_rng(0)
    exact, errors = misfit.parameters(misfit.start()), []
    for _ in range(count):
        first = exact * draw(random, len(exact))
        start = misfit.with_values(dict(zip(misfit.names, first, strict=True)))
        errors.append(np.abs(searched(load().identifier(method)(), start, PATIENCE) / exact - 1.0).max())
    return np.array(errors)


def _noisy(toy: str, truth: Model, noise: float) -> str:
    values, bounds, inside = [], [], []
    for seed in range(DRAWS):
        misfit = _misfit(truth, (1.0,), noise, seed)
        table = run(MultiStart(least_drop=1e-3), misfit).parameters
        exact = misfit.parameters(misfit.start())
        jacobian = misfit.residual_and_jacobian(misfit.start())[1] / misfit.scaling(misfit.start())
        bounds.append(np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))))
        values.append(table["value"].values - exact)
        inside.append((table["interval_lower"].values <= exact) & (exact <= table["interval_upper"].values))
    bound = np.mean(bounds, axis=0)
    scatter = np.sqrt(np.mean(np.square(values), axis=0)) / bound
    bias = np.abs(np.mean(values, axis=0)) / (bound / np.sqrt(DRAWS))
    return f"| {toy} | {100 * noise:g} % | {scatter.max():.2f} | {bias.max():.1f} | {100 * np.mean(inside):.0f} % |"


def _identified(truth: Model, speeds: tuple[float, ...], noise: float, seed: int = 0) -> Model:
    misfit = _misfit(truth, speeds, noise, seed, toys.start_from(truth, 0.8))
    values = searched(MultiStart(), misfit)
    return truth.with_values(dict(zip(misfit.names, values.tolist(), strict=True)))


def _misfit(truth: Model, speeds: tuple[float, ...], noise: float, seed: int = 0, model: Model | None = None) -> Misfit:
    registry, random = load(), np.random.default_rng(seed)
    clean = toys.problem(truth, model or truth, registry.spring_laws, registry.observers, speeds, exact=True)
    if not noise:
        return clean
    noisy = {run: toys.noisy(tree, noise, random) for run, tree in clean.recordings.items()}
    return Misfit(clean.model, noisy, registry.spring_laws, registry.observers)


def _changed(model: Model, factors: dict[str, float]) -> Model:
    return model.with_values({path: factor * model.parameters()[path].value for path, factor in factors.items()})
