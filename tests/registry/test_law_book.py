"""Sums of laws: what is added takes part in loading and unloading, and what cannot be added is refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crashkit.mechanics import Simulator
from crashkit.model import Body, GivenMotion, Joint, Model, Parameter
from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.registry.law_book import LawBook, are_parallel, can_be_added, can_take, fit_together, multiplies
from crashkit_spring_laws import SPRING_LAWS

BOOK = LawBook({law.name: law for law in SPRING_LAWS})
ALPHA, DELTA, GAMMA, BETA = 1e6, 1e5, 0.3, 5e5
SLOPE = 4e6
P, PEAK = 5e4, 0.02
deformations = st.floats(0.0, 0.6)


def plateau(d: float) -> float:
    """The loading curve, written out once more."""
    return min(ALPHA * d, DELTA) + BETA * max(0.0, d - GAMMA)


def peak(d: float) -> float:
    return P * (d / PEAK) * math.exp(1.0 - d / PEAK)


def crush(
    name: str, d: float, d_max: float, *added: float, slope: float = SLOPE, rate: float = 0.0, gap: float = 0.0
) -> float:
    return BOOK[name].force(d, 1.0, d_max, ALPHA, DELTA, GAMMA, BETA, slope, rate, gap, 0.0, 0.0, 0.0, *added)


@given(d=deformations)
def test_loading_is_the_sum_of_both_curves(d):
    assert crush("crush_plateau + peak", d, d, P, PEAK, 1.0) == pytest.approx(plateau(d) + peak(d), rel=1e-12, abs=1e-6)


@given(d_max=deformations, share=st.floats(0.0, 1.0))
def test_unloading_follows_the_first_laws_slope_from_the_sum(d_max, share):
    d = share * d_max
    expected = max(0.0, plateau(d_max) + peak(d_max) - SLOPE * (d_max - d))
    assert crush("crush_plateau + peak", d, d_max, P, PEAK, 1.0) == pytest.approx(expected, rel=1e-9, abs=1e-3)


@given(d=deformations, d_max=deformations)
def test_without_a_slope_of_its_own_it_unloads_along_the_sum(d, d_max):
    d_max = max(d, d_max)
    assert crush("crush_plateau + peak", d, d_max, P, PEAK, 1.0, slope=0.0) == pytest.approx(
        plateau(d) + peak(d), rel=1e-9, abs=1e-6
    )


@given(d=deformations)
def test_the_rate_factor_multiplies_the_sum(d):
    assert crush("crush_plateau + peak", d, d, P, PEAK, 1.0, rate=0.5) == pytest.approx(1.5 * (plateau(d) + peak(d)), abs=1e-6)


@given(d=deformations, d_max=deformations)
def test_what_is_added_vanishes_with_its_amplitude(d, d_max):
    d_max = max(d, d_max)
    assert crush("crush_plateau + peak", d, d_max, 0.0, PEAK, 1.0) == crush("crush_plateau", d, d_max)


@given(d=deformations)
def test_sums_can_be_added_to(d):
    name = "crush_plateau + peak + linear_stop"
    total = crush(name, d, d, P, PEAK, 1.0, 2e6, 0.4)
    assert total == pytest.approx(plateau(d) + peak(d) + 2e6 * max(0.0, d - 0.4), rel=1e-12, abs=1e-6)


@given(d=deformations)
def test_a_table_can_be_added(d):
    heights, reach = [1e3, -2e3, 3e3, 4e3], 0.5
    alone = BOOK["smooth_table"].force(d, 1.0, d, heights, reach, 0.0, 1e-3)
    assert crush("crush_plateau + smooth_table", d, d, heights, reach, 0.0, 1e-3) == pytest.approx(
        plateau(d) + alone, abs=1e-6
    )


def test_a_sum_declares_what_its_parts_declare():
    both = BOOK["crush_plateau + peak"]
    assert both.name == "crush_plateau + peak"
    assert both.unit == "N"
    assert both.parameters == (*BOOK["crush_plateau"].parameters, *BOOK["peak"].parameters)
    assert issubclass(both, SpringLaw)


def test_a_sum_is_the_same_class_each_time():
    assert BOOK["crush_plateau + peak"] is BOOK["crush_plateau + peak"]


UNKNOWN = [
    "no_such_law",
    "crush_plateau + no_such_law",
    "no_such_law + peak",
    "crush_plateau +peak",
    "crush_plateau + ",
    " + peak",
    "",
]


@pytest.mark.parametrize("name", UNKNOWN)
def test_an_unknown_name_is_a_key_error(name):
    assert name not in BOOK
    with pytest.raises(KeyError, match="law|peak|plateau|''| "):
        BOOK[name]


CLASHES = {
    "peak + crush_plateau": "a peak has no loading curve to add to",
    "crush_plateau + rate_linear": "a factor is no force",
    "crush_plateau + tie": "a law with several returns cannot stand in another",
    "crush_plateau + crush_plateau": "parameters of the same names",
    "crush_plateau + peak + peak": "parameters of the same names",
    "crush_plateau + viscous": "both have a clearance",
    "crush_plateau ~ peak": "a peak has no memory",
    "maxwell ~ quasi_linear": "both have a memory",
}


@pytest.mark.parametrize("name", CLASHES, ids=CLASHES.values())
def test_laws_that_do_not_fit_together_are_refused(name):
    assert name not in BOOK
    with pytest.raises(KeyError, match="."):
        BOOK[name]


def test_what_fits_is_told_beforehand():
    assert can_take(BOOK["crush_plateau"]) and can_take(BOOK["piecewise_affine"]) and not can_take(BOOK["peak"])
    assert can_be_added(BOOK["folding"]) and not can_be_added(BOOK["tie"])
    assert fit_together(BOOK["crush_plateau"], BOOK["peak"])
    assert not fit_together(BOOK["crush_plateau"], BOOK["viscous"])


def test_only_installed_laws_are_listed():
    assert list(BOOK) == [law.name for law in SPRING_LAWS]
    assert len(BOOK) == len(SPRING_LAWS)


class Clashing(SpringLaw):
    """Uses names that the plateau uses for something else."""

    name = "clashing"
    parameters = (ParameterSpec("height", "N", "force at a unit of deformation"),)

    @staticmethod
    def force(d: float, ddot: float, d_max: float, height: float) -> float:
        static = d + 1.0
        x = static * height
        return x


@given(d=deformations)
def test_variables_of_the_same_name_are_kept_apart(d):
    book = LawBook({"crush_plateau": BOOK["crush_plateau"], "clashing": Clashing})
    force = book["crush_plateau + clashing"].force(d, 0.0, d, ALPHA, DELTA, GAMMA, BETA, SLOPE, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0)
    assert force == pytest.approx(plateau(d) + 7.0 * (d + 1.0), rel=1e-12)


# ---- side by side, and times a factor ----

RELAXING, TIME = 2e5, 0.02


@given(d=deformations, q=st.floats(0.0, 0.3))
def test_laws_stand_side_by_side(d, q):
    both = BOOK["crush_plateau | maxwell"]
    force = both.force(d, 1.0, d, q, ALPHA, DELTA, GAMMA, BETA, SLOPE, 0.0, 0.0, 0.0, 0.0, 0.0, RELAXING, TIME, 0.0, 1e-3)
    assert force == pytest.approx(plateau(d) + max(0.0, RELAXING * (d - q)), rel=1e-12, abs=1e-6)
    rate = both.memory_rate(d, 1.0, d, q, ALPHA, DELTA, GAMMA, BETA, SLOPE, 0.0, 0.0, 0.0, 0.0, 0.0, RELAXING, TIME, 0.0, 1e-3)
    assert rate == pytest.approx((d - q) / TIME)
    assert both.memory == "dashpot_deformation"


@given(d=deformations, rate=st.floats(-5.0, 5.0))
def test_a_joint_that_only_pushes_lets_go_where_the_sum_would_pull(d, rate):
    numbers = (ALPHA, DELTA, GAMMA, BETA, SLOPE, 0.0, 0.0, 0.0, 0.0, 0.0, 3e4, 1e-3)
    force = BOOK["crush_plateau & viscous"].force(d, rate, d, *numbers)
    assert force == pytest.approx(max(0.0, BOOK["crush_plateau | viscous"].force(d, rate, d, *numbers)), rel=1e-12, abs=1e-9)


def test_what_is_declared_alike_is_one():
    names = [spec.name for spec in BOOK["crush_plateau | viscous"].parameters]
    assert names.count("clearance") == 1
    gap = BOOK["crush_plateau | viscous"].force(
        0.3, 2.0, 0.3, ALPHA, DELTA, GAMMA, BETA, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1e3, 1e-3
    )
    assert gap == pytest.approx(plateau(0.2) + 2e3)


def test_a_factor_multiplies_one_of_them():
    law = BOOK["linear_stop * rate_linear | coulomb"]
    assert law.unit == "N"
    assert [spec.name for spec in law.parameters] == [
        "stiffness",
        "stop_deformation",
        "rate_slope",
        "friction_force",
        "slip_rate",
        "always",
        "engagement",
        "stick",
        "stick_rate",
        "clearance",
        "tail",
        "rebound",
    ]
    force = law.force(0.3, 2.0, 0.3, 1e5, 0.1, 0.5, 3e3, 0.05, 1.0, 1e-3, 0.0, 1.0, 0.0, 0.0, 1.0)
    assert force == pytest.approx(2.0 * 2e4 + 3e3 * math.tanh(40.0))


def test_signs_bind_in_their_order():
    law = BOOK["coulomb | crush_plateau + peak * rate_linear"]
    assert [part.name for part in law.parts] == ["coulomb", "crush_plateau", "peak", "rate_linear"]
    friction, member = (3e3, 0.05, 1.0, 1e-3, 0.0, 1.0, 0.0, 0.0, 1.0), (ALPHA, DELTA, GAMMA, BETA, 0.0, 0.0, 0.0, 0.0, 0.0)
    force = law.force(0.01, 1.0, 0.01, *friction, *member, P, PEAK, 1.0, 0.5)
    assert force == pytest.approx(3e3 * math.tanh(20.0) + 1.5 * (plateau(0.01) + peak(0.01)))


def test_what_one_of_them_declares_holds_for_all():
    assert BOOK["coulomb | brittle"].jumps
    assert not BOOK["coulomb | smooth_table"].passive
    assert BOOK["tension_spring * tear"].memory == "damage"


# ---- a share that stays crushed ----


@given(d_max=deformations, back=st.floats(0.0, 1.0), share=st.floats(0.0, 1.0))
def test_of_a_share_that_stays_crushed_the_rest_is_elastic(d_max, back, share):
    d = (1.0 - back) * d_max
    crushed = max(0.0, plateau(d_max) - SLOPE * (d_max - d))
    expected = share * crushed + (1.0 - share) * plateau(d)
    force = crush("crush_plateau % plastic_share", d, d_max, share, rate=0.1)
    assert force == pytest.approx(1.1 * expected, rel=1e-9, abs=1e-3)


def test_a_share_can_lose_its_force_by_a_factor():
    law = "crush_plateau * unloading_loss % plastic_share"
    force = crush(law, 0.2, 0.25, 1.0, 0.05, 0.3, slope=1.0)  # a slope of 1 N/m: it keeps the force that it had
    assert force == pytest.approx(0.3 * plateau(0.25) * math.exp(-1.0) + 0.7 * plateau(0.2), rel=1e-6)


# ---- unloading along two lines ----


@given(d_max=deformations, back=st.floats(0.0, 1.0), turning=st.floats(0.05, 0.95), ratio=st.floats(0.01, 1.0))
def test_from_some_force_on_it_unloads_less_steeply(d_max, back, turning, ratio):
    d = (1.0 - back) * d_max
    top, turn = plateau(d_max), (1.0 - turning) * plateau(d_max) / SLOPE
    on_second = turning * top - ratio * SLOPE * (d_max - d - turn)
    expected = top - SLOPE * (d_max - d) if d_max - d < turn else max(0.0, on_second)
    force = crush("crush_plateau / second_line", d, d_max, turning, ratio)
    assert force == pytest.approx(expected, rel=1e-9, abs=1e-3)


def test_only_a_share_may_unload_along_two_lines():
    force = crush("crush_plateau / second_line % plastic_share", 0.2, 0.21, 0.5, 0.1, 0.3)
    two_lines = crush("crush_plateau / second_line", 0.2, 0.21, 0.5, 0.1)
    assert force == pytest.approx(0.3 * two_lines + 0.7 * plateau(0.2))


NOT_SIDE_BY_SIDE = {
    "maxwell | bouc_wen": "two memories",
    "linear_stop | tension_spring": "parameters of one name that mean different things",
    "crush_plateau | rate_linear": "a factor is no force",
    "rate_linear * crush_plateau": "a law is no factor",
    "coulomb * viscous": "a law is no factor",
    "crush_plateau % maxwell": "a law is no share",
    "linear_stop / second_line": "what has no line of unloading has no second one",
    "crush_plateau / plastic_share": "a share is no line",
    "maxwell % plastic_share": "what has a memory has no share without it",
    "measured_curve | coulomb": "a law with branches of its own stands alone",
    "coulomb |viscous": "a sign stands between blanks",
    "coulomb | ": "nothing is beside it",
}


@pytest.mark.parametrize("name", NOT_SIDE_BY_SIDE, ids=NOT_SIDE_BY_SIDE.values())
def test_what_cannot_stand_side_by_side_is_refused(name):
    assert name not in BOOK
    with pytest.raises(KeyError, match="."):
        BOOK[name]


def test_what_can_stand_side_by_side_is_told_beforehand():
    assert are_parallel(BOOK["crush_plateau"], BOOK["maxwell"])
    assert not are_parallel(BOOK["crush_plateau"], BOOK["rate_linear"])
    assert multiplies(BOOK["crush_plateau"], BOOK["fracture"])
    assert not multiplies(BOOK["maxwell"], BOOK["tear"])


# ---- through a memory ----


@given(d=deformations, q=st.floats(0.0, 1e5))
def test_a_force_passes_through_a_memory(d, q):
    law = BOOK["crush_plateau ~ quasi_linear"]
    numbers = (ALPHA, DELTA, GAMMA, BETA, SLOPE, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, TIME, 1.0)
    assert law.memory == "faded_force"
    assert law.force(d, 1.0, d, q, *numbers) == pytest.approx(1.5 * plateau(d) - 0.5 * q, rel=1e-9, abs=1e-6)
    assert law.memory_rate(d, 1.0, d, q, *numbers) == pytest.approx((plateau(d) - q) / TIME, rel=1e-9, abs=1e-3)


def test_a_step_of_the_force_fades_as_the_standard_linear_solid_does():
    """Held after a quick load: F = F_a (1 + s exp(-t / tau)), as the engine integrates it."""
    law, parameters = "linear_stop ~ quasi_linear", {"stiffness": 1e6, "stop_deformation": 0.0}
    times = np.linspace(0.0, 0.1, 1001)
    held = GivenMotion(tuple(times), tuple((0.05 * min(1.0, t / 1e-3),) for t in times))
    bodies = (Body("wall", (0.0,), (0.0,), fixed=True), Body("ram", (1.0,), (0.0,), motion=held))
    own = {name: Parameter(value) for name, value in {**parameters, "fresh_share": 0.5, "relaxation_time": TIME}.items()}
    model = Model("relaxing", ("x",), bodies, (Joint("pad", ("ram", "wall"), law, own),))
    motion = Simulator(model, BOOK).run(np.array([0.05, 0.06]), step=1e-5)
    expected = 5e4 * (1.0 + 0.5 * np.exp(-(motion["time"].values - 5e-4) / TIME))
    assert motion["force"].values[:, 0] == pytest.approx(expected, rel=2e-3)
