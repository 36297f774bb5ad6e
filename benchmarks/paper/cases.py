"""The paper's starts and what it reached from them (Mizzi & Jezequel 1992, Tables 1 to 4)."""

from collections.abc import Sequence

import numpy as np
from attrs import evolve, frozen

from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.registry import load
from crashkit.testing import toys
from crashkit.testing.toys import RHO, Spring

ONE = ("α", "β", "γ", "δ")
NINE = ("α1", "β1", "γ1", "δ1", "α2", "β2", "γ2", "δ2", "η")
THRESHOLDS = ("crush_force", "densification_deformation")
NOMINAL = (1.2, 1.2, 0.6, 0.24)
TWO = (*NOMINAL, *NOMINAL, 0.7, 2.4)


@frozen
class Case:
    """One line of the paper's tables.

    Arguments:
        table: its number.
        title: what it is.
        method: the paper's.
        first: the start: α β γ δ, once or for both springs, then η and ρ.
        reached: by the paper, in the same order.
        clamped: whether the thresholds are known.
    """

    table: int
    title: str
    method: str
    first: tuple[float, ...]
    reached: tuple[float, ...]
    clamped: bool = False

    @property
    def is_single(self) -> bool:
        """Whether it has one degree of freedom."""
        return len(self.first) == 4

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters; ρ is none of its own, as it only multiplies α2, β2 and δ2."""
        return ONE if self.is_single else NINE


CASES = (
    Case(1, "near start", "integral filter", (0.9, 0.9, 0.35, 0.14), (1.2, 1.202, 0.6, 0.24)),
    Case(1, "near start, thresholds known", "integral filter", (0.9, 0.9, 0.35, 0.14), (1.2, 1.2, 0.6, 0.24), True),
    Case(1, "far start, thresholds known", "integral filter", (0.4, 1.5, 0.85, 0.1), (1.2, 1.2, 0.6, 0.24), True),
    Case(
        2,
        "growing slices",
        "gradient",
        (1.0, 1.0, 0.5, 0.2, 1.0, 1.0, 0.5, 0.2, 0.5, 2.0),
        (1.05, 0.969, 0.64, 0.195, 1.08, 0.997, 0.527, 0.197, 0.742, 2.05),
    ),
    Case(
        3,
        "start 20 % above",
        "integral filter",
        tuple(1.2 * value for value in TWO),
        (0.967, 1.170, 0.530, 0.195, 1.047, 1.023, 0.616, 0.205, 0.769, 2.4),
    ),
    Case(
        3,
        "start 30 % below",
        "integral filter",
        tuple(0.7 * value for value in TWO),
        (0.693, 0.840, 0.516, 0.230, 1.089, 1.903, 0.709, 0.517, 0.41, 1.981),
    ),
    Case(
        4,
        "thresholds free",
        "integral filter",
        (0.9, 0.9, 0.4, 0.17, 0.9, 0.9, 0.4, 0.17, 0.5, 1.8),
        (0.460, 1.070, 0.608, 0.275, 2.244, 1.282, 0.299, 0.377, 0.385, 2.055),
    ),
    Case(
        4,
        "thresholds known",
        "integral filter",
        (0.9, 0.9, 0.6, 0.24, 0.9, 0.9, 0.6, 0.24, 0.5, 1.8),
        (1.181, 1.204, 0.600, 0.236, 1.150, 1.101, 0.600, 0.230, 0.713, 2.39),
        True,
    ),
)


def truth_of(case: Case, printed: bool = False) -> Model:
    """The reference model; of two degrees by either reading of the masses."""
    if case.is_single:
        return toys.one_degree()
    return toys.two_degrees(rear_mass=_rear_mass(0.7, printed))


def start_of(case: Case, printed: bool = False) -> Model:
    """The reference model at the case's start; known thresholds are fixed at their true values.

    The motion sees only ρ times α2, β2 and δ2, so these begin at their product.
    """
    truth = truth_of(case, printed)
    if case.is_single:
        started = toys.one_degree(spring=_spring(case.first))
    else:
        first, second, (eta, rho) = case.first[:4], case.first[4:8], case.first[8:]
        started = toys.two_degrees(1.0, _rear_mass(eta, printed), _spring(first), _spring(second), rho)
    model = truth.at({path: parameter.value for path, parameter in started.free_parameters().items()})
    if case.clamped:
        known = {path: p for path, p in truth.free_parameters().items() if path.endswith(THRESHOLDS)}
        model = model.with_parameters({path: evolve(p, fixed=True) for path, p in known.items()})
    return model


def problem_of(case: Case, printed: bool = False, speeds: Sequence[float] = (1.0,)) -> Misfit:
    """Its recordings at speed 1, without noise."""
    registry = load()
    truth, start = truth_of(case, printed), start_of(case, printed)
    return toys.problem(truth, start, registry.spring_laws, registry.observers, tuple(speeds), exact=True)


def numbers(model: Model, printed: bool = False) -> np.ndarray:
    """The parameters in the paper's units and order: α β γ δ, or both springs' and η, with ρ at its reference."""
    first = toys.spring_of(model, "first")
    if len(model.joints) == 1:
        return np.array([first.alpha, first.beta, first.gamma, first.delta])
    rear = model.parameters()["body.rear.mass"].value / toys.MASS
    # The second spring's stiffness is ρ m'/m times the paper's α2; the reference's ρ tells the others apart.
    second = toys.spring_of(model, "second", RHO * rear)
    eta = 1.0 / rear if printed else rear
    return np.array([*_values(first), *_values(second), eta])


def predicted(model: Model, speed: float) -> np.ndarray:
    """Accelerations of all bodies, (time, body), at a speed, in the paper's unit of force over mass."""
    simulator = Simulator(model, load().spring_laws)
    motion = simulator.run(toys.TIMES, initial=toys.initial_state(model, speed), step=toys.STEP)
    return np.asarray(motion["acceleration"].values[:, 1:, 0]) * toys.MASS / toys.STIFFNESS


def _rear_mass(eta: float, printed: bool) -> float:
    return 1.0 / eta if printed else eta


def _spring(values: Sequence[float]) -> Spring:
    alpha, beta, gamma, delta = values
    return Spring(alpha, beta, gamma, delta)


def _values(spring: Spring) -> tuple[float, ...]:
    return spring.alpha, spring.beta, spring.gamma, spring.delta
