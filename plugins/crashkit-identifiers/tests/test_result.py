"""What every result says: intervals that cover, what is not seen, how far a method stopped from the least misfit."""

import numpy as np
import pytest
from attrs import define, evolve

from crashkit.misfit import Misfit
from crashkit.misfit.bands import CONFIDENCE
from crashkit.protocols import Status
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_identifiers.result import conclude
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity


@define
class Residuals:
    """Residuals of one function, with its derivative, of plain parameters."""

    function: object
    first: np.ndarray
    lower: float = -np.inf
    upper: float = np.inf

    @property
    def names(self):
        return tuple("abcdefgh"[: len(self.first)])

    def start(self):
        return np.array(self.first, float)

    def bounds(self):
        return np.full(len(self.first), self.lower), np.full(len(self.first), self.upper)

    def residual(self, scaled):
        return self.function(scaled)[0]

    def residual_and_jacobian(self, scaled):
        return self.function(scaled)

    def parameters(self, scaled):
        return np.array(scaled)

    def scaling(self, scaled):
        return np.ones(len(scaled))


def concluded(function, point, **bounds):
    problem = Residuals(function, np.array(point), **bounds)
    return conclude(problem, np.array(point, float), Status.CONVERGED, ((0.0, np.array(point, float)),))


MATRIX = np.random.default_rng(0).normal(size=(40, 3))
NOISE = np.random.default_rng(1).normal(size=40)
BEST = np.linalg.lstsq(MATRIX, NOISE)[0]


def linear(point):
    return MATRIX @ point - NOISE, MATRIX


def row(found, name="a"):
    return {key: value.item() for key, value in found.parameters.sel(parameter=name, parameter_2=name).data_vars.items()}


def test_at_the_least_misfit_of_a_linear_problem_intervals_are_those_of_regression():
    found = concluded(linear, BEST)
    std = np.sqrt(np.diag(np.linalg.inv(MATRIX.T @ MATRIX)))
    assert found.parameters["std"].values == pytest.approx(std)
    assert found.parameters["interval_lower"].values == pytest.approx(BEST - CONFIDENCE * std)
    assert found.parameters["interval_upper"].values == pytest.approx(BEST + CONFIDENCE * std)
    assert found.parameters.attrs["remarks"] == ""


def test_a_method_that_stopped_a_little_off_says_so_and_still_covers():
    off = BEST + [0.3, 0.0, 0.0]
    found, at_best = concluded(linear, off), concluded(linear, BEST)
    assert found.parameters.attrs["remarks"] == "The least misfit lies elsewhere: it would still move a."
    assert row(found)["std"] > 0.3
    for name in "abc":
        assert row(found, name)["interval_lower"] <= row(at_best, name)["interval_lower"]
        assert row(found, name)["interval_upper"] >= row(at_best, name)["interval_upper"]


def test_a_method_that_stopped_far_off_claims_nothing():
    found = concluded(linear, BEST + [5.0, 0.0, 0.0], lower=-9.0, upper=9.0)
    assert found.parameters.attrs["remarks"].endswith("It is too far away for intervals.")
    assert np.isnan(found.parameters["std"].values).all()
    assert found.parameters["interval_lower"].values.tolist() == [-9.0] * 3


def test_residuals_above_the_noise_widen_what_is_claimed():
    found, at_noise = (concluded(lambda p, s=s: (MATRIX @ p - s * NOISE, MATRIX), s * BEST) for s in (3.0, 1.0))
    ratio = found.parameters["std"].values / at_noise.parameters["std"].values
    expected = 3.0 * np.sqrt(np.sum((MATRIX @ BEST - NOISE) ** 2) / 37.0)
    assert ratio == pytest.approx(expected)
    assert found.parameters.attrs["remarks"].startswith("What remains is")
    assert found.parameters.attrs["normalised_residual"] == pytest.approx(
        3.0 * at_noise.parameters.attrs["normalised_residual"]
    )


def threshold(point):
    """Nothing is seen of a once it is above 1: r = 10 min(a - 1, 0), and b on its own."""
    below = min(point[0] - 1.0, 0.0)
    return np.array([10.0 * below, point[1]]), np.array([[10.0 * (below < 0.0), 0.0], [0.0, 1.0]])


def test_a_threshold_is_known_from_one_side():
    found = concluded(threshold, [1.5, 0.0])
    assert row(found)["interval_lower"] == pytest.approx(1.0 - CONFIDENCE / 10.0, abs=0.02)
    assert row(found)["interval_upper"] == np.inf
    assert not row(found)["identifiable"]
    assert "a is at least 0." in found.unseen[-1] and found.unseen[-1].endswith("how much more these recordings do not see")


def test_a_crooked_misfit_is_profiled():
    """r = exp(a): the curvature at a = 0 reaches equally far to both sides, the misfit does not."""

    def crooked(point):
        return np.exp(point) - 1.0 + 0.0 * point, np.diag(np.exp(point))

    found = concluded(crooked, [0.0])
    assert row(found)["interval_upper"] == pytest.approx(np.log(1.0 + CONFIDENCE), abs=0.05)
    assert row(found)["interval_lower"] < -CONFIDENCE


def test_where_the_curvature_is_right_nothing_is_searched_again():
    """One Jacobian, a look along the way left, and one look at each end."""
    asked = []

    def counted(point):
        asked.append(point)
        return linear(point)

    concluded(counted, BEST)
    assert len(asked) <= 2 + 2 * 3


def test_at_a_kink_a_promise_that_is_not_kept_is_no_way():
    """r = (1 + 5 max(a, 0), a + b - 1): the derivative at a = 0 promises that a smaller a lowers the misfit; it does not."""

    def kinked(point):
        above = float(point[0] >= 0.0)
        residual = np.array([1.0 + 5.0 * max(point[0], 0.0), 3.0 * (point[0] + point[1] - 1.0), 40.0 * (point[1] - 1.0)])
        return residual, np.array([[5.0 * above, 0.0], [3.0, 3.0], [0.0, 40.0]])

    found = concluded(kinked, [0.0, 1.0])
    assert found.parameters.attrs["remarks"] == ""
    assert row(found)["interval_lower"] < 0.0 < row(found)["interval_upper"] < 0.4


def test_parameters_that_are_not_seen_are_named_one_by_one_and_have_no_interval():
    target = NOISE + 5.0 * MATRIX[:, 0]
    best = np.linalg.lstsq(MATRIX[:, :1], target)[0].item()
    found = concluded(lambda point: (MATRIX[:, :1] @ point[:1] - target, MATRIX * [1.0, 0.0, 0.0]), [best, 2.0, 3.0])
    assert set(found.unseen) == {"b is not seen by these recordings", "c is not seen by these recordings"}
    for name in "bc":
        assert (row(found, name)["interval_lower"], row(found, name)["interval_upper"]) == (-np.inf, np.inf)
        assert not row(found, name)["identifiable"]
    assert row(found)["std"] == pytest.approx(1.0 / np.linalg.norm(MATRIX[:, 0]))


def test_what_is_not_seen_does_not_lead_a_seen_one_astray():
    """b and c only count as their product, so that b may be anything; the interval of a is that without them."""

    def product(point):
        a, b, c = point
        return np.array([10.0 * (a - 1.0), 5.0 * (a + b * c - 2.0)]), np.array([[10.0, 0.0, 0.0], [5.0, 5.0 * c, 5.0 * b]])

    found = concluded(product, [1.0, 1.0, 1.0])
    assert row(found)["interval_upper"] == pytest.approx(1.0 + CONFIDENCE / 10.0, rel=0.02)
    assert found.unseen[0].startswith("only a combination is seen: ") and found.unseen[0].endswith("can change together")
    assert not any("a is" in sentence for sentence in found.unseen)
    for name in "bc":
        assert not row(found, name)["identifiable"]


TIME = np.linspace(0.1, 1.0, 20)


def slope(point):
    """y = a b t, of which 6 t was read: r = 10 (a b - 6) t."""
    a, b = point
    return 10.0 * (a * b - 6.0) * TIME, 10.0 * np.outer(TIME, [b, a])


def parallel(point):
    """Two springs side by side, in logarithms: only the sum of the stiffnesses, 3, is seen."""
    first, second = np.exp(point)
    return 10.0 * (first + second - 3.0) * TIME, 10.0 * np.outer(TIME, [first, second])


def series(point):
    """Two springs end to end, in logarithms: only the sum of the compliances, 3, is seen."""
    residual, jacobian = parallel(-np.asarray(point))
    return residual, -jacobian


def test_of_a_product_alone_neither_factor_has_an_interval():
    found = concluded(slope, [2.0, 3.0], lower=0.0)
    for name in "ab":
        assert not row(found, name)["identifiable"]
        assert row(found, name)["interval_lower"] < 0.01 and row(found, name)["interval_upper"] == np.inf
        assert row(found, name)["std"] == np.inf
    assert found.unseen[0].startswith("only a combination is seen: ")


def test_of_a_product_a_bound_of_one_factor_bounds_the_other():
    found = concluded(slope, [2.0, 3.0], lower=np.array([0.0, 2.7]), upper=np.array([9.0, 3.3]))
    assert row(found)["identifiable"]
    assert row(found)["interval_lower"] == pytest.approx(6.0 / 3.3, abs=0.05)
    assert row(found)["interval_upper"] == pytest.approx(6.0 / 2.7, abs=0.05)


@pytest.mark.parametrize(("springs", "end", "told"), [(parallel, "upper", "at most"), (series, "lower", "at least")])
def test_of_a_sum_alone_each_part_is_known_from_one_side(springs, end, told):
    sign = 1.0 if springs is parallel else -1.0
    found = concluded(springs, sign * np.log([1.0, 2.0]))
    for name in "ab":
        assert not row(found, name)["identifiable"]
        assert row(found, name)[f"interval_{end}"] == pytest.approx(sign * np.log(3.0), abs=0.05)
        assert any(sentence.startswith(f"{name} is {told}") for sentence in found.unseen)
        assert np.isinf(row(found, name)["std"])


def test_a_value_at_its_bound_is_limited_from_the_other_side():
    """r = (10 (a + 0.1), 10 (a + b)): the least misfit within the bound is at a = 0, and b follows."""

    def pushed(point):
        a, b = point
        return np.array([10.0 * (a + 0.1), 10.0 * (a + b)]), np.array([[10.0, 0.0], [10.0, 10.0]])

    found = concluded(pushed, [0.0, 0.0], lower=np.array([0.0, -9.0]))
    assert row(found)["at_bound"] and np.isnan(row(found)["std"])
    assert row(found)["interval_lower"] == 0.0
    assert row(found)["interval_upper"] == pytest.approx(np.sqrt(0.01 + CONFIDENCE**2 / 100.0) - 0.1, rel=0.1)
    assert not any(sentence.startswith("a is") for sentence in found.unseen)


def test_from_accelerations_alone_neither_mass_nor_forces_are_known(search):
    """All of them by the same factor move as before; a deformation at which a plateau ends is known."""
    truth, registry = toys.one_degree(), load()
    mass = evolve(truth.parameters()["body.front.mass"], fixed=False)
    runs = {name: tree.drop_nodes("film") for name, tree in search(truth, 1.0, noise=0.01).recordings.items()}
    problem = Misfit(truth.with_parameters({"body.front.mass": mass}), runs, registry.spring_laws, registry.observers)
    found = run(Sensitivity(), problem)
    table = found.parameters.set_index(parameter="parameter")
    for name in set(found.values) - {"joint.first.densification_deformation"}:
        one = table.sel(parameter=name)
        assert not one["identifiable"], name
        assert one["interval_lower"] <= one["lower"] + 0.01 * one["value"] and one["interval_upper"] >= one["upper"], name
    assert table.sel(parameter="joint.first.densification_deformation")["identifiable"]


def test_intervals_of_repeated_tests_cover_as_often_as_they_say(search):
    truth, registry, random = toys.one_degree(), load(), np.random.default_rng(5)
    clean = search(truth, 1.0).recordings
    inside = []
    for _ in range(25):
        noisy = {name: toys.noisy(tree, 0.03, random) for name, tree in clean.items()}
        found = run(Sensitivity(least_drop=1e-3), Misfit(truth, noisy, registry.spring_laws, registry.observers)).parameters
        values = [parameter.value for parameter in truth.free_parameters().values()]
        inside += list((found["interval_lower"].values <= values) & (values <= found["interval_upper"].values))
    assert 86 <= sum(inside) <= 100  # of 95 expected, 4 sigma


def test_the_second_spring_s_end_of_plateau_is_only_a_lower_limit(search):
    """By the paper's own mass ratio spring 2 never passes its plateau at speed 1."""
    truth = toys.two_degrees()
    found = run(Sensitivity(), search(truth, 0.9, noise=0.01))
    end, slope = (f"joint.second.densification_{kind}" for kind in ("deformation", "stiffness"))
    seen = dict(zip(found.parameters["parameter"].values, found.parameters["identifiable"].values, strict=True))
    assert [name for name, is_seen in seen.items() if not is_seen] == [end, slope]
    interval = found.parameters.sel(parameter=end)
    assert 0.48 < float(interval["interval_lower"]) < 0.6 < float(interval["interval_upper"])
    assert any(sentence.startswith(f"{end} is at least 0.") for sentence in found.unseen)


def test_of_the_paper_s_ten_parameters_nine_are_seen(search):
    registry, nine = load(), toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    ten = toys.with_ten_parameters(nine)
    laws = {**registry.spring_laws, "stiffness_ratio": toys.StiffnessRatio}
    problem = toys.problem(ten, toys.start_from(ten, 0.9), laws, registry.observers, speeds=(1.0, 1.5))
    found = run(Sensitivity(), problem)
    together = [f"joint.second.{name}" for name in ("ratio", "elastic_stiffness", "crush_force", "densification_stiffness")]
    told = [sentence for sentence in found.unseen if sentence.startswith("only a combination is seen")]
    assert len(told) == 1 and all(name in told[0] for name in together)
    for path in set(nine.free_parameters()) - set(together):
        assert found.values[path] == pytest.approx(nine.parameters()[path].value, rel=1e-4), path
    for name in together[1:]:
        product = found.values[name] * found.values[together[0]]
        assert product == pytest.approx(nine.parameters()[name].value, rel=1e-4)


def test_units_are_those_of_the_laws(search):
    found = run(Sensitivity(step_limit=1), search(toys.two_degrees()))
    units = dict(zip(found.parameters["parameter"].values, found.parameters["units"].values, strict=True))
    assert units["body.rear.mass"] == "kg"
    assert units["joint.first.elastic_stiffness"] == "N m-1"
    assert units["joint.second.densification_deformation"] == "m"


@pytest.mark.parametrize("method", ["sensitivity", "optimal_control"])
def test_what_is_known_beforehand_is_believed_and_narrows(search, method):
    truth = toys.two_degrees()
    problem = search(truth, 0.9, noise=0.03)
    free, told = (run(load().identifier(method)(prior=prior), problem) for prior in (np.inf, 0.02))
    slope = "joint.second.densification_stiffness"  # which these recordings do not see
    start = problem.model.parameters()[slope].value
    assert told.values[slope] == pytest.approx(start, rel=1e-3)
    assert float(told.parameters["std"].sel(parameter=slope)) == pytest.approx(0.02 * start, rel=0.05)
    assert bool(told.parameters["identifiable"].sel(parameter=slope))
    both = told.parameters["std"].values < free.parameters["std"].values
    assert both[np.isfinite(free.parameters["std"].values)].all()


def test_fixed_thresholds_are_left_alone(search, errors):
    truth = toys.one_degree()
    clamped = [path for path in truth.free_parameters() if path.endswith(("crush_force", "densification_deformation"))]
    held = {path: evolve(truth.parameters()[path], fixed=True) for path in clamped}
    start = toys.start_from(truth, 0.4).with_parameters(held)
    found = run(Sensitivity(), search(truth, start))
    assert len(found.values) == 2 and found.status is Status.CONVERGED
    for path, value in found.values.items():
        assert value == pytest.approx(truth.parameters()[path].value, rel=1e-4)
