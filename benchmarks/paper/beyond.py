"""What the paper did not try: starts far off, noise, faster tests, structures that are changed afterwards."""

import numpy as np
from attrs import frozen

from benchmarks.identification import searched
from benchmarks.paper.cases import predicted
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_identifiers.multi_start import MultiStart

NINE = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
TOYS = {"one degree": toys.one_degree(), "two degrees": NINE}
NOISES = (0.01, 0.03, 0.1)
DRAWS = 12
FASTER = (1.5, 2.0)


@frozen
class Share:
    """How often a method arrives."""

    toy: str
    start: str
    method: str
    found: int
    of: int


def far_starts(count: int) -> list[Share]:
    """Within 50 %, and with every parameter three times too large or too small."""
    kinds = {
        "within 50 %": lambda random, n: random.uniform(0.5, 1.5, n),
        "three times too large or small": lambda random, n: 3.0 ** random.choice([-1, 1], n),
    }
    return [
        Share(toy, kind, method, _arrivals(truth, method, draw, count), count)
        for toy, truth in TOYS.items()
        for kind, draw in kinds.items()
        for method in ("multi_start", "sensitivity")
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
                model = _identified(truth, speeds, noise)
                errors = [relative(model, truth, speed) for speed in FASTER]
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


def _arrivals(truth: Model, method: str, draw, count: int) -> int:  # type: ignore[no-untyped-def]
    misfit, random = _misfit(truth, (1.0,), 0.0), np.random.default_rng(0)
    exact, found = misfit.parameters(misfit.start()), 0
    for _ in range(count):
        first = exact * draw(random, len(exact))
        start = misfit.with_values(dict(zip(misfit.names, first, strict=True)))
        found += bool(np.abs(searched(load().identifier(method)(), start) / exact - 1.0).max() < 1e-8)
    return found


def _noisy(toy: str, truth: Model, noise: float) -> str:
    values, bounds, inside = [], [], []
    for seed in range(DRAWS):
        misfit = _misfit(truth, (1.0,), noise, seed)
        method = MultiStart(least_drop=1e-3)
        state = method.start(misfit)
        while state.status.name == "RUNNING":
            state = method.step(misfit, state)
        table = method.finish(misfit, state).parameters
        exact = misfit.parameters(misfit.start())
        jacobian = misfit.residual_and_jacobian(misfit.start())[1] / misfit.scaling(misfit.start())
        bounds.append(np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))))
        values.append(table["value"].values - exact)
        inside.append((table["interval_lower"].values <= exact) & (exact <= table["interval_upper"].values))
    bound = np.mean(bounds, axis=0)
    scatter = np.sqrt(np.mean(np.square(values), axis=0)) / bound
    bias = np.abs(np.mean(values, axis=0)) / (bound / np.sqrt(DRAWS))
    return f"| {toy} | {100 * noise:g} % | {scatter.max():.2f} | {bias.max():.1f} | {100 * np.mean(inside):.0f} % |"


def _identified(truth: Model, speeds: tuple[float, ...], noise: float) -> Model:
    start = toys.start_from(truth, 0.8)
    misfit = _misfit(truth, speeds, noise, model=start)
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
