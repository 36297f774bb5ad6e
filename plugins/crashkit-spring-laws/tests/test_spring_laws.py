"""Every law keeps the contract, and has the values that its docstring gives."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crashkit.testing import SpringLawContract
from crashkit.testing.spring_law_probe import Probe
from crashkit_spring_laws import (
    SPRING_LAWS,
    ArchedPeak,
    BellPeak,
    BoucWen,
    Brake,
    Brittle,
    Bump,
    Coulomb,
    CrushPlateau,
    CrushStop,
    Dahl,
    DampedStop,
    DecayingPeak,
    DelayedSoftening,
    DippingPeak,
    DrivenCurve,
    ExponentialStop,
    Fading,
    Folding,
    FoldingShare,
    Fracture,
    Hook,
    HuntCrossley,
    LinearStop,
    LockingStop,
    LostForce,
    Maxwell,
    MeasuredCurve,
    Pad,
    Peak,
    PiecewiseAffine,
    PlasticShare,
    PointedPeak,
    PowerStop,
    Pulse,
    QuadraticStop,
    QuasiLinear,
    RateCurve,
    RateEyring,
    RateLinear,
    RateLogarithm,
    RatePower,
    RateRising,
    RateSaturating,
    RateTable,
    ResidualSet,
    Rubbing,
    RubbingGap,
    SecondLine,
    SmoothSoftening,
    SmoothTable,
    Softening,
    StepwiseSoftening,
    Tear,
    TensionSpring,
    Tie,
    TimeTable,
    UnloadingLoss,
    Viscous,
    ViscousGrowing,
    ViscousKnee,
    ViscousPower,
    ViscousSaturating,
    YieldingStrap,
)

PLATEAU = {
    "elastic_stiffness": 1.1e6,
    "crush_force": 1.2e5,
    "densification_deformation": 0.35,
    "densification_stiffness": 9e5,
}
MEASURED = {"deformation": [0.04, 0.1, 0.2, 0.5], "force": [5e4, 8e4, 5e4, 2e5]}
CORNERS = {"deformation": [0.1, 0.2, 0.5], "force": [8e4, 5e4, 2e5], "final_stiffness": 4e5}

EXAMPLES = [
    (CrushPlateau, PLATEAU),
    (CrushPlateau, PLATEAU | {"unloading_stiffness": 4e6, "rate_coefficient": 0.02, "clearance": 0.05}),
    (CrushPlateau, PLATEAU | {"unloading_stiffness": 4e6, "rate_coefficient": 0.02, "tension": 1.0}),
    (CrushPlateau, PLATEAU | {"unloading_stiffness": 4e6, "tension": 1.0, "tension_force": 2e4}),
    (PiecewiseAffine, CORNERS),
    (PiecewiseAffine, CORNERS | {"rate_coefficient": 0.03, "tension": 1.0}),
    (PiecewiseAffine, CORNERS | {"unloading_stiffness": 2e6, "rate_coefficient": 0.1, "clearance": 0.1}),
    (PiecewiseAffine, {"deformation": [0.0], "force": [0.0], "final_stiffness": 1e5}),
    (RateLinear, {"rate_slope": 0.02}),
    (RatePower, {"rate_amplitude": 0.3, "rate_exponent": 0.2}),
    (RateLogarithm, {"rate_amplitude": 0.1, "reference_rate": 0.5}),
    (RateSaturating, {"rate_amplitude": 0.4, "reference_rate": 2.0}),
    (RateSaturating, {"rate_amplitude": 0.4, "reference_rate": 2.0, "limit_sharpness": 3.0}),
    (RateEyring, {"rate_amplitude": 0.1, "reference_rate": 0.5}),
    (RateRising, {"rises": [0.0, 0.2, 0.1], "rising_reach": 5.0}),
    (Viscous, {"damping": 3e3, "clearance": 0.1}),
    (ViscousGrowing, {"damping": 3e3, "doubling_deformation": 0.15}),
    (ViscousKnee, {"damping": 3e3, "knee_rate": 1.0, "beyond": 0.2}),
    (ViscousSaturating, {"damping": 3e3, "saturating_rate": 4.0}),
    (Coulomb, {"friction_force": 5e3}),
    (Coulomb, {"friction_force": 5e3, "slip_rate": 0.5, "always": 0.0, "clearance": 0.1}),
    (Coulomb, {"friction_force": 5e3, "stick": 0.6, "stick_rate": 2.0}),
    (Coulomb, {"friction_force": 5e3, "slip_rate": 0.5, "tail": 1.0}),
    (Dahl, {"friction_force": 5e3, "bristle_length": 0.02}),
    (Dahl, {"friction_force": 5e3, "bristle_length": 0.05, "always": 0.0}),
    (Rubbing, {"friction_share": 0.3, "slip_rate": 0.2}),
    (Rubbing, {"friction_share": 0.3, "slip_rate": 0.2, "stick": 0.5, "stick_rate": 1.0}),
    (RubbingGap, {"friction_force": 5e3, "slip_rate": 0.2, "clearance": 0.2, "engagement": 0.05}),
    (LinearStop, {"stiffness": 1e6, "stop_deformation": 0.3}),
    (CrushStop, {"stiffness": 1e6, "stop_deformation": 0.2, "crush_length": 0.1, "release": 3.0}),
    (ExponentialStop, {"force": 1e4, "stop_deformation": 0.3, "growth_way": 0.1}),
    (HuntCrossley, {"force": 4e4, "stop_deformation": 0.2, "exponent": 1.5, "loss": 0.3}),
    (DampedStop, {"stiffness": 1e6, "stop_deformation": 0.2, "damping": 2e4}),
    (QuadraticStop, {"coefficient": 1e6, "stop_deformation": 0.3}),
    (PowerStop, {"force": 4e4, "stop_deformation": 0.2, "exponent": 2.5}),
    (LockingStop, {"stiffness": 1e6, "stop_deformation": 0.3, "locking_way": 0.2}),
    (Pad, {"pad_force": 3e4, "pad_exponent": 2.0, "clearance": 0.2}),
    (TensionSpring, {"stiffness": 1e6}),
    (TensionSpring, {"stiffness": 1e6, "slack": 0.05}),
    (YieldingStrap, {"stiffness": 1e6, "slack": 0.05, "yield_force": 2e4, "corner": 3.0}),
    (Hook, {"pull_force": 2e4, "play": 0.02, "pull_exponent": 2.0}),
    (Hook, {"pull_force": 2e4, "play": 0.02, "pull_exponent": 2.0, "pull_limit": 3e4}),
    (Peak, {"peak_force": 5e4, "peak_deformation": 0.1}),
    (Peak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_sharpness": 8.0}),
    (DippingPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.05, "dip": 0.5, "recovery": 0.1}),
    (Folding, {"amplitude": 2e4, "fold_length": 0.3, "onset": 0.2}),
    (Folding, {"amplitude": 2e4, "fold_length": 0.2, "skew": 0.9, "arch": 0.4, "shortening": 0.1, "weakening": 0.3}),
    (Folding, {"amplitude": 2e4, "fold_length": 0.2, "skew": -0.4, "shortening": -0.1, "weakening": 0.05}),
    (Folding, {"amplitude": 2e4, "fold_length": 0.2, "skew": 0.3, "weakening": 0.05, "pointedness": 0.9}),
    (Folding, {"amplitude": 2e4, "fold_length": 0.2, "skew": 0.3, "weakening": 0.05, "pointedness": -20.0}),
    (FoldingShare, {"fold_share": 0.1, "fold_length": 0.3, "onset": 0.2}),
    (FoldingShare, {"fold_share": 0.1, "fold_length": 0.2, "skew": 0.9, "pointedness": 0.9}),
    (FoldingShare, {"fold_share": 0.1, "fold_length": 0.2, "skew": -0.5, "pointedness": -20.0}),
    (SmoothTable, {"heights": [1e4, -2e4, 3e4], "reach": 0.6}),
    (Bump, {"bump_force": -2e4, "bump_deformation": 0.3, "bump_width": 0.1}),
    (RateTable, {"heights": [-1e4, 0.0, 2e4, 3e4], "reach": 10.0}),
    (RateCurve, {"rate_heights": [-0.4, 0.0, 0.2, 0.1], "rate_reach": 10.0}),
    (DrivenCurve, {"driver_heights": [-0.4, 0.0, 0.2, 0.1], "driver_reach": 0.6}),
    (MeasuredCurve, MEASURED),
    (MeasuredCurve, MEASURED | {"unloading_stiffness": 2e6, "clearance": 0.1}),
    (PointedPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.06}),
    (PointedPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.2}),
    (PointedPeak, {"peak_force": 5e4, "peak_deformation": 0.2, "peak_width": 0.05, "peak_rise": 0.15}),
    (BellPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.06}),
    (ArchedPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.06, "peak_power": 1.0}),
    (ArchedPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.2, "peak_power": 1.7}),
    (DecayingPeak, {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.06, "peak_rise": 0.02}),
    (DecayingPeak, {"peak_force": 5e4, "peak_deformation": 0.02, "peak_width": 0.06, "peak_rise": 0.1}),
    (BoucWen, {"stiffness": 1e6, "yield_force": 5e4}),
    (BoucWen, {"stiffness": 1e6, "yield_force": 5e4, "hardening": 0.1, "sharpness": 1.0}),
    (ViscousPower, {"damping": 1e4, "exponent": 0.6}),
    (ViscousPower, {"damping": 1e4, "exponent": 2.0, "tension": 1.0}),
    (ViscousPower, {"damping": 1e4, "exponent": 1.0, "tension": 1.0, "rebound": 0.4}),
    (Maxwell, {"relaxing_stiffness": 1e6, "relaxation_time": 0.02}),
    (Maxwell, {"relaxing_stiffness": 1e6, "relaxation_time": 0.005, "clearance": 0.05, "tension": 1.0}),
    (Fracture, {"fracture_deformation": 0.3, "loss": 0.7}),
    (Brittle, {"stiffness": 1e6, "fracture_deformation": 0.3}),
    (Tear, {"tear_extension": 0.05, "loss": 0.7}),
    (LostForce, {"lost_force": 3e4, "softening_deformation": 0.1, "softening_length": 0.05}),
    (UnloadingLoss, {"loss": 0.4, "unloading_length": 0.05}),
    (ResidualSet, {"loss": 0.9, "residual_share": 0.6, "unloading_exponent": 1.5}),
    (PlasticShare, {"plastic_share": 0.3}),
    (SecondLine, {"turning_share": 0.5, "slope_ratio": 0.3}),
    (Softening, {"softening_deformation": 0.3, "softening_length": 0.2, "loss": 0.7}),
    (SmoothSoftening, {"softening_middle": 0.3, "softening_spread": 0.05, "loss": 0.7}),
    (
        StepwiseSoftening,
        {"softening_deformation": 0.2, "softening_length": 0.1, "loss": 0.3, "step_way": 0.2, "second_loss": 0.2},
    ),
    (DelayedSoftening, {"softening_deformation": 0.3, "loss": 0.5, "delay": 0.004, "duration": 0.002}),
    (Fading, {"fading_share": 0.6, "relaxation_time": 0.02}),
    (QuasiLinear, {"fresh_share": 0.6, "relaxation_time": 0.02, "holds": 1.0}),
    (Tie, {"stiffness": 1e6, "damping": 2e3, "slack": 0.05}),
    (Tie, {"stiffness": 1e6, "damping": 2e3, "slack": 0.05, "holds": 1.0}),
    (Tie, {"stiffness": 1e6, "slack": 0.05, "stiffening": 2.0}),
]


@pytest.fixture(params=EXAMPLES, ids=lambda example: example[0].name)
def example(request):
    return request.param


class TestSpringLaws(SpringLawContract):
    @pytest.fixture
    def law(self, example):
        return example[0]

    @pytest.fixture
    def parameters(self, example):
        return example[1]


@pytest.fixture(
    params=[
        (TimeTable, {"heights": [1e4, -2e4, 3e4], "duration": 0.2}),
        (Pulse, {"pulse_force": -2e4, "pulse_time": 0.05, "rise_time": 0.01, "fall_time": 0.03}),
        (Brake, {"friction_force": 5e3, "start": 0.02, "rise": 0.01}),
    ],
    ids=lambda example: example[0].name,
)
def of_the_time(request):
    return request.param


class TestForceOfTheTime(SpringLawContract):
    """The memory is the time itself, which passes at rest too."""

    preload = True

    @pytest.fixture
    def law(self, of_the_time):
        return of_the_time[0]

    @pytest.fixture
    def parameters(self, of_the_time):
        return of_the_time[1]


class TestForceAtNoDeformation(SpringLawContract):
    """A force that rises within 0.1 mm is followed in small steps."""

    largest_deformation = 0.01

    @pytest.fixture
    def law(self):
        return PiecewiseAffine

    @pytest.fixture
    def parameters(self):
        return {"deformation": [0.0, 0.003], "force": [6e4, 8e4], "final_stiffness": 1e5}


def test_every_law_is_tested():
    assert {law for law, _ in EXAMPLES} | {TimeTable, Pulse, Brake} == set(SPRING_LAWS)


def value(law, d, ddot=0.0, d_max=None, **parameters):
    values = [parameters.get(spec.name, spec.default) for spec in law.parameters]
    return law.force(d, ddot, max(d, 0.0) if d_max is None else d_max, *values)


@pytest.mark.parametrize(("d", "expected"), [(-0.1, 0.0), (0.05, 5.5e4), (0.2, 1.2e5), (0.35, 1.2e5), (0.45, 1.2e5 + 9e4)])
def test_crush_plateau_loading(d, expected):
    assert value(CrushPlateau, d, **PLATEAU) == pytest.approx(expected)
    assert value(CrushPlateau, d + 0.07, **PLATEAU, clearance=0.07) == pytest.approx(expected)
    assert value(CrushPlateau, d, ddot=3.0, **PLATEAU, rate_coefficient=0.1) == pytest.approx(1.3 * expected)
    assert value(CrushPlateau, d, ddot=-30.0, **PLATEAU, rate_coefficient=0.1) == 0.0


def test_crush_plateau_without_a_plateau():
    """A densification that begins before the crush force is reached begins where it is reached."""
    early = PLATEAU | {"densification_deformation": 0.01}
    assert value(CrushPlateau, 0.2, **early) == pytest.approx(1.2e5 + 9e5 * (0.2 - 1.2e5 / 1.1e6))


@pytest.mark.parametrize(("law", "parameters"), [(CrushPlateau, PLATEAU), (PiecewiseAffine, CORNERS)])
def test_unloading_and_reloading_follow_one_line(law, parameters):
    top = value(law, 0.3, **parameters)
    for d in (0.29, 0.27, 0.29, 0.3):
        assert value(law, d, d_max=0.3, **parameters, unloading_stiffness=2e6) == pytest.approx(top - 2e6 * (0.3 - d))
    assert value(law, 0.1, d_max=0.3, **parameters, unloading_stiffness=2e6) == 0.0
    assert value(law, 0.1, d_max=0.3, **parameters, unloading_stiffness=2e6, tension=1.0) == pytest.approx(top - 4e5)
    assert value(law, 0.27, d_max=0.3, **parameters) == pytest.approx(value(law, 0.27, **parameters))


def test_tension_pulls():
    assert value(CrushPlateau, -0.1, **PLATEAU, tension=1.0) == pytest.approx(-1.1e5)
    assert value(PiecewiseAffine, -0.1, **CORNERS, tension=1.0) == pytest.approx(-8e4)


@pytest.mark.parametrize(("law", "parameters"), [(CrushPlateau, PLATEAU), (PiecewiseAffine, CORNERS)])
def test_a_joint_pulls_with_no_more_than_it_bears(law, parameters):
    pulls = parameters | {"unloading_stiffness": 2e6, "tension": 1.0, "tension_force": 3e4}
    top = value(law, 0.3, **pulls)
    forces = [value(law, 0.3 - (top + pull) / 2e6, d_max=0.3, **pulls) for pull in (0.0, 2e4, 3e4, 9e4)]
    assert forces == pytest.approx([0.0, -2e4, -3e4, -3e4], abs=1e-6)


@pytest.mark.parametrize(("law", "parameters"), [(CrushPlateau, PLATEAU), (PiecewiseAffine, CORNERS)])
def test_the_rate_raises_what_resists_and_lowers_what_is_given_back(law, parameters):
    pulls = parameters | {"tension": 1.0, "rate_coefficient": 0.02}
    for d in (-0.1, 0.1):
        at_rest, apart, together = (value(law, d, ddot=ddot, **pulls) for ddot in (0.0, -5.0, 5.0))
        resisting, returning = (together, apart) if d > 0.0 else (apart, together)
        assert resisting == pytest.approx(1.1 * at_rest)
        assert returning == pytest.approx(0.9 * at_rest)
        assert value(law, d, ddot=math.copysign(60.0, -d), **pulls) == 0.0


@settings(max_examples=60, deadline=None)
@given(
    law=st.sampled_from([CrushPlateau, PiecewiseAffine]),
    unloading=st.just(0.0) | st.floats(1.1e6, 1e7),
    rate=st.floats(0.0, 0.2),
    clearance=st.floats(0.0, 0.2),
    toe=st.just(0.0) | st.floats(1e-3, 0.1),
    tension=st.sampled_from([0.0, 0.5, 1.0]),
    reach=st.floats(0.05, 1.0),
    seed=st.integers(0, 1000),
)
def test_no_motion_gains_energy(law, unloading, rate, clearance, toe, tension, reach, seed):
    """Pushing and pulling, at any rate: what was taken in is never exceeded by what is given back."""
    shape = PLATEAU if law is CrushPlateau else CORNERS
    varied = {
        "unloading_stiffness": unloading,
        "rate_coefficient": rate,
        "clearance": 0.0 if tension else clearance,
        "toe": toe,
        "tension": tension,
    }
    stored, taken = Probe(law, shape | varied, (reach, 20.0)).energy(seed)
    assert stored >= -1e-4 * taken - 1e-12


@pytest.mark.parametrize(
    ("d", "expected"), [(-0.1, 0.0), (0.05, 4e4), (0.1, 8e4), (0.15, 6.5e4), (0.35, 1.25e5), (0.6, 2.4e5)]
)
def test_piecewise_affine_loading(d, expected):
    assert value(PiecewiseAffine, d, **CORNERS) == pytest.approx(expected)


@pytest.mark.parametrize(("d", "equivalent"), [(0.05, 0.0), (0.12, 0.005), (0.14, 0.02), (0.35, 0.23)])
@pytest.mark.parametrize(("law", "shape"), [(CrushPlateau, PLATEAU), (PiecewiseAffine, CORNERS)])
def test_a_toe_engages_along_a_parabola(law, shape, d, equivalent):
    soft = shape | {"clearance": 0.1, "toe": 0.04}
    assert value(law, d, **soft) == pytest.approx(value(law, equivalent, **shape))


def test_a_force_at_no_deformation_is_reached_within_a_tenth_of_a_millimetre():
    preload = {"deformation": [0.0, 0.3], "force": [6e4, 9e4]}
    assert value(PiecewiseAffine, 0.0, **preload) == 0.0
    assert value(PiecewiseAffine, 1e-4, **preload) == pytest.approx(6e4 + 10.0)
    assert value(PiecewiseAffine, 0.1, **preload) == pytest.approx(7e4)


def test_rate_factors():
    assert value(RatePower, 0.1, ddot=8.0, rate_amplitude=0.5, rate_exponent=1.0 / 3.0) == pytest.approx(
        1.0 + 0.5 * (2.0 - 0.01 ** (1.0 / 3.0)), rel=1e-6
    )
    assert value(RatePower, 0.1, ddot=-8.0, rate_amplitude=0.5, rate_exponent=0.3) == 1.0
    assert value(RateLogarithm, 0.1, ddot=3.0, rate_amplitude=0.1, reference_rate=1.0) == pytest.approx(1 + 0.1 * math.log(4))
    limited = [value(RateSaturating, 0.1, ddot=rate, rate_amplitude=0.4, reference_rate=2.0) for rate in (-3.0, 2.0, 1e9)]
    assert limited == pytest.approx([1.0, 1.2, 1.4])
    both_ways = [value(RateEyring, 0.1, ddot=rate, rate_amplitude=0.1, reference_rate=0.5) for rate in (-3.0, 3.0, -1e9)]
    assert both_ways == pytest.approx([1.0 - 0.1 * math.asinh(6.0), 1.0 + 0.1 * math.asinh(6.0), 0.0])


def test_a_damper_may_grow_with_the_stroke():
    """Both ways, and not before it is in contact."""
    orifices = {"damping": 1000.0, "doubling_deformation": 0.1}
    forces = [
        value(ViscousGrowing, d, ddot=rate, **orifices) for d, rate in ((0.1, 2.0), (0.3, 2.0), (0.3, -1.0), (-0.1, 2.0))
    ]
    assert forces == pytest.approx([4000.0, 8000.0, -4000.0, 0.0])


def test_a_damper_may_have_a_knee():
    """Both ways, and not before it is in contact."""
    valve = {"damping": 1000.0, "knee_rate": 2.0, "beyond": 0.25}
    forces = [value(ViscousKnee, 0.1, ddot=rate, **valve) for rate in (-6.0, -1.0, 1.0, 6.0)]
    assert forces == pytest.approx([-3000.0, -1000.0, 1000.0, 3000.0])
    assert value(ViscousKnee, -0.1, ddot=6.0, **valve) == 0.0


def test_a_damper_may_saturate():
    """It gives half of its limit at its own rate; fixed at both ends it also acts in an open joint."""
    damper = {"damping": 1000.0, "saturating_rate": 2.0}
    forces = [value(ViscousSaturating, 0.1, ddot=rate, **damper) for rate in (-2.0, 1e-3, 2.0, 1e6)]
    assert forces == pytest.approx([-1000.0, 1.0, 1000.0, 2000.0], rel=1e-3)
    assert value(ViscousSaturating, -0.1, ddot=2.0, **damper) == 0.0
    assert value(ViscousSaturating, -0.1, ddot=2.0, tension=1.0, **damper) == pytest.approx(1000.0)


def test_a_hook_may_yield():
    hook = {"pull_force": 1000.0, "play": 0.02, "pull_exponent": 2.0, "way": 0.01, "pull_limit": 2500.0}
    assert [value(Hook, d, d_max=0.1, **hook) for d in (0.09, 0.07, 0.05)] == pytest.approx([0.0, -1000.0, -2500.0])


def test_a_factor_may_rise_in_steps():
    """Not at rest, nor on the way back; behind the last step by all of them together; one step alone about its middle."""
    rising = [value(RateRising, 0.1, ddot=rate, rises=[0.0, 0.3, 0.0], rising_reach=6.0) for rate in (-3.0, 0.0, 3.0, 60.0)]
    assert rising == pytest.approx([1.0, 1.0, 1.0 + 0.15 * math.tanh(2.25), 1.0 + 0.15 * (1.0 + math.tanh(2.25))])


@pytest.mark.parametrize("rate", [0.01, 0.3, 5.0])
def test_friction_may_be_long_in_reaching_its_full_force(rate):
    tailed = value(Coulomb, 0.1, rate, friction_force=100.0, slip_rate=0.2, tail=1.0)
    assert tailed == pytest.approx(200.0 / np.pi * np.arctan(0.5 * np.pi * rate / 0.2))
    assert tailed <= value(Coulomb, 0.1, rate, friction_force=100.0, slip_rate=0.2)


def test_what_the_force_itself_presses_rubs_in_proportion_to_it():
    there, rest, back = (value(Rubbing, 0.1, ddot=rate, friction_share=0.3, slip_rate=0.2) for rate in (5.0, 0.0, -5.0))
    assert (there, rest, back) == pytest.approx((1.3, 1.0, 0.7))


def test_peak_comes_once():
    shape = {"peak_force": 5e4, "peak_deformation": 0.1}
    assert value(Peak, 0.1, **shape) == pytest.approx(5e4)
    assert value(Peak, 0.1, d_max=0.5, **shape) == 0.0


def test_a_sharp_peak_is_narrow():
    shape = {"peak_force": 5e4, "peak_deformation": 0.1, "peak_sharpness": 16.0}
    forces = [value(Peak, d, **shape) for d in (0.0, 0.025, 0.1, 0.175)]
    assert forces[::2] == pytest.approx([0.0, 5e4])
    assert max(forces[1], forces[3]) < 0.06 * 5e4


def test_a_pointed_peak_has_straight_flanks_from_nothing_on():
    narrow, wide = ({"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": width} for width in (0.04, 0.2))
    assert [value(PointedPeak, d, **narrow) for d in (0.05, 0.08, 0.1, 0.13, 0.2)] == pytest.approx(
        [0.0, 25e3, 5e4, 12.5e3, 0.0]
    )
    assert [value(PointedPeak, d, **wide) for d in (0.0, 0.05, 0.1, 0.2)] == pytest.approx([0.0, 25e3, 5e4, 25e3])
    assert value(PointedPeak, 0.08, d_max=0.1, **narrow) == pytest.approx(25e3)
    assert value(PointedPeak, 0.1, d_max=0.5, **narrow) == 0.0


def test_a_pointed_peak_may_rise_for_longer_than_it_falls():
    uneven = {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.02, "peak_rise": 0.08}
    assert [value(PointedPeak, d, **uneven) for d in (0.02, 0.06, 0.1, 0.11, 0.12)] == pytest.approx(
        [0.0, 25e3, 5e4, 25e3, 0.0], abs=1e-6
    )
    assert value(PointedPeak, 0.09, d_max=0.1, **uneven) == pytest.approx(25e3)  # back along the steeper flank
    early = {**uneven, "peak_deformation": 0.04}
    assert value(PointedPeak, 0.02, **early) == pytest.approx(25e3)  # from nothing at 0


def test_a_bell_begins_at_nothing():
    shape = {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.06}
    forces = [value(BellPeak, d, **shape) for d in (0.0, 0.1, 0.16, 1.0)]
    assert forces == pytest.approx([0.0, 5e4, 5e4 / math.e, 0.0], abs=1e-6)
    assert value(BellPeak, 0.1, d_max=0.5, **shape) == 0.0


@pytest.mark.parametrize(("power", "halfway"), [(1.0, math.sqrt(0.5)), (2.0, 0.5)])
def test_an_arched_peak_is_a_half_sine_or_a_haversine(power, halfway):
    shape = {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.1, "peak_power": power}
    forces = [value(ArchedPeak, d, **shape) for d in (0.0, 0.05, 0.1, 0.15, 0.2, 0.3)]
    assert forces == pytest.approx([0.0, halfway * 5e4, 5e4, halfway * 5e4, 0.0, 0.0], abs=1e-6)
    assert value(ArchedPeak, 0.09, d_max=0.1, **shape) == pytest.approx(5e4 * (1.0 - 0.05 * math.pi))


def test_a_peak_that_decays_rises_in_a_line_and_is_lost_little_by_little():
    shape = {"peak_force": 5e4, "peak_deformation": 0.1, "peak_width": 0.06, "peak_rise": 0.04}
    forces = [value(DecayingPeak, d, **shape) for d in (0.05, 0.08, 0.1, 0.16, 0.22)]
    assert forces == pytest.approx([0.0, 25e3, 5e4, 5e4 / math.e, 5e4 / math.e**2])
    assert value(DecayingPeak, 0.09, d_max=0.1, **shape) == pytest.approx(37.5e3)  # back along the steeper flank


def test_folding_swings_about_nothing_and_lets_go():
    shape = {"amplitude": 2e4, "fold_length": 0.2, "onset": 0.1}
    assert value(Folding, 0.15, **shape) == pytest.approx(2e4)
    assert value(Folding, 0.25, **shape) == pytest.approx(-2e4)
    assert value(Folding, 0.05, **shape) == 0.0
    assert value(Folding, 0.1, d_max=0.15, **shape) == 0.0


def test_folds_in_proportion_have_the_shape_of_those_that_are_not():
    shape = {"fold_length": 0.2, "onset": 0.1, "skew": 0.4, "pointedness": 0.8}
    deformations = np.linspace(0.0, 0.7, 50)
    shares = [value(FoldingShare, d, fold_share=0.1, **shape) for d in deformations]
    forces = [value(Folding, d, amplitude=2e4, **shape) for d in deformations]
    assert shares == pytest.approx([1.0 + 0.1 * force / 2e4 for force in forces])
    assert value(FoldingShare, 0.1, d_max=0.45, fold_share=0.1, **shape) == value(FoldingShare, 0.45, fold_share=0.1, **shape)


def test_folds_may_be_pointed_or_blunt():
    """Near 1 a triangle; below 0 the mean of their height is larger than a sine's; on either side of 0 the same sine."""
    x = np.linspace(0.0, 0.4, 401)

    def folds(pointedness):
        return np.array([value(Folding, d, amplitude=1.0, fold_length=0.2, pointedness=pointedness) for d in x])

    sine = np.sin(2.0 * np.pi * x / 0.2)
    assert folds(0.99) == pytest.approx(2.0 / np.pi * np.arcsin(sine), abs=0.05)
    assert folds(1e-9) == pytest.approx(sine, abs=1e-6)
    assert folds(-1e-9) == pytest.approx(sine, abs=1e-6)
    heights = [np.mean(np.abs(folds(p))) for p in (0.9, 0.0, -5.0, -50.0)]
    assert heights == sorted(heights)


def test_folds_have_a_shape():
    folds = {"amplitude": 1.0, "fold_length": 0.2}
    x = np.linspace(0.0, 0.2, 2001)

    def crest(**shape):
        return 1e-4 * np.argmax([value(Folding, d, **folds, **shape) for d in x])

    assert crest() == pytest.approx(0.05, abs=1e-4)
    assert crest(skew=0.9) < 0.03 and crest(skew=-0.9) > 0.07
    above = [np.mean([value(Folding, d, **folds, arch=arch) > -0.5 for d in x]) for arch in (0.0, 0.3, 0.6)]
    assert above == sorted(above) and above[2] > above[0] + 0.05
    shorter = [value(Folding, d, **folds, shortening=0.1) for d in np.linspace(0.0, 1.0, 10001)]
    crossings = 1e-4 * np.flatnonzero(np.diff(np.signbit(shorter)))
    assert np.all(np.diff(np.diff(crossings)) < 0.0)
    longer = [value(Folding, d, **folds, shortening=-0.1) for d in np.linspace(0.0, 1.0, 10001)]
    crossings = 1e-4 * np.flatnonzero(np.diff(np.signbit(longer)))
    assert np.all(np.diff(np.diff(crossings)) > 0.0)
    nearly_even = [value(Folding, 0.53, **folds, shortening=s) for s in (-1e-7, 1e-7)]
    assert nearly_even == pytest.approx([value(Folding, 0.53, **folds)] * 2, abs=1e-4)
    first, third = (value(Folding, d, **folds, weakening=0.5) for d in (0.05, 0.45))
    assert third / first == pytest.approx(math.exp(-1.0))


def test_skewed_folds_are_nearly_a_saw():
    x = np.linspace(0.03, 0.17, 29)
    saw = [value(Folding, d, amplitude=1.0, fold_length=0.2, skew=0.98) for d in x]
    assert saw == pytest.approx(0.5 * np.pi * (1.0 - x / 0.1) / np.arcsin(0.98), abs=0.02)
    release = [value(Folding, d, d_max=0.01, amplitude=1.0, fold_length=0.2, skew=0.95) for d in (0.01, 0.009, 0.0)]
    assert release == sorted(release, reverse=True) and release[-1] == 0.0


def test_a_stop_stiffens_without_end_and_then_in_a_straight_line():
    stop = {"force": 1e3, "stop_deformation": 0.2, "growth_way": 0.05}
    forces = [value(ExponentialStop, d, **stop) for d in (0.1, 0.25, 0.7, 0.75, 0.8)]
    assert forces[:3] == pytest.approx([0.0, 1e3 * math.expm1(1.0), 1e3 * math.expm1(10.0)])
    assert forces[4] - forces[3] == pytest.approx(forces[3] - forces[2])


def test_a_tie_may_stiffen_either_way():
    belt = {"stiffness": 1e5, "slack": 0.05, "stiffening": 4.0}
    assert [value(Tie, d, **belt) for d in (-0.15, 0.03, 0.15)] == pytest.approx([-1.4e4, 0.0, 1.4e4])


def test_a_damper_may_be_weaker_on_the_way_back():
    valves = {"damping": 1e3, "exponent": 1.0, "tension": 1.0, "rebound": 0.4}
    assert [value(ViscousPower, -0.1, ddot=rate, **valves) for rate in (-2.0, 2.0)] == pytest.approx([-800.0, 2e3])


def test_a_stop_with_a_dashpot_sets_in_with_the_rate_and_parts_while_it_is_pressed():
    stop = {"stiffness": 1e5, "stop_deformation": 0.2, "damping": 1e3}
    states = [(0.19, 2.0), (0.2005, 2.0), (0.24, 2.0), (0.24, 0.0), (0.24, -2.0), (0.24, -5.0)]
    forces = [value(DampedStop, d, ddot=rate, **stop) for d, rate in states]
    assert forces == pytest.approx([0.0, 50.0 + 1e3, 6e3, 4e3, 2e3, 0.0])


def test_a_contact_takes_up_energy_as_it_is_struck():
    contact = {"force": 4e4, "way": 0.1, "stop_deformation": 0.2, "loss": 0.3}
    forces = [value(HuntCrossley, 0.24, ddot=rate, **contact) for rate in (-5.0, 0.0, 2.0)]
    assert forces == pytest.approx([0.0, 4e4 * 0.4**1.5, 1.6 * 4e4 * 0.4**1.5])
    assert value(HuntCrossley, 0.2, ddot=2.0, **contact) == 0.0


def test_tables():
    """Each bump stands alone in its middle but for exp(-1 / 0.64) of its neighbours."""
    share = math.exp(-1.0 / 0.64)
    table = {"heights": [1e4, -2e4], "reach": 0.6}
    forces = [value(SmoothTable, d, **table) for d in (-0.1, 0.0, 0.15, 0.45)]
    assert forces == pytest.approx([0.0, 0.0, 1e4 - 2e4 * share, 1e4 * share - 2e4])
    rates = {"heights": [-1e4, 2e4], "reach": 10.0}
    forces = [value(RateTable, 0.1, ddot=rate, **rates) for rate in (-5.0, 5.0)]
    assert forces == pytest.approx([-1e4 + 2e4 * share, -1e4 * share + 2e4])
    assert value(RateTable, 0.0, ddot=5.0, **rates) == 0.0
    factors = [value(RateCurve, 0.1, ddot=rate, rate_heights=[-0.1, 0.2], rate_reach=10.0) for rate in (-5.0, 5.0)]
    assert factors == pytest.approx([0.9 + 0.2 * share, 1.2 - 0.1 * share])
    assert value(RateCurve, 0.1, ddot=5.0, rate_heights=[0.0, -2.0], rate_reach=10.0) == 0.0


def test_a_driven_factor_stays_beyond_its_reach_as_it_is_there():
    share, table = math.exp(-1.0 / 0.64), {"driver_heights": [-0.1, 0.2], "driver_reach": 0.6}
    within = [value(DrivenCurve, d, **table) for d in (0.15, 0.45)]
    assert within == pytest.approx([0.9 + 0.2 * share, 1.2 - 0.1 * share], abs=1e-3)
    end, beyond = (value(DrivenCurve, d, **table) for d in (0.61, 2.0))
    assert beyond == pytest.approx(end, abs=0.01) and beyond > 1.1


def test_a_force_of_the_time_acts_whether_or_not_there_is_contact():
    table = {"heights": [1e4, -2e4], "duration": 0.2}
    forces = [TimeTable.force(d, 0.0, max(d, 0.0), 0.05, **table) for d in (-0.1, 0.0, 0.3)]
    assert forces == pytest.approx([1e4 - 2e4 * math.exp(-1.0 / 0.64)] * 3)
    assert TimeTable.memory_rate(0.1, 2.0, 0.1, 0.05, **table) == 1.0


def test_a_pulse_comes_and_goes_once_whether_or_not_there_is_contact():
    pulse = {"pulse_force": 3e4, "pulse_time": 0.04, "rise_time": 0.01, "fall_time": 0.02}
    forces = [Pulse.force(d, 0.0, max(d, 0.0), 0.04, **pulse) for d in (-0.1, 0.0, 0.3)]
    assert forces == [3e4] * 3
    early, late, gone = (Pulse.force(0.1, 0.0, 0.1, time, **pulse) for time in (0.03, 0.06, 0.2))
    assert (early, late) == pytest.approx((3e4 / math.e, 3e4 / math.e))
    assert abs(gone) < 1e-9
    assert Pulse.memory_rate(0.1, 2.0, 0.1, 0.05, **pulse) == 1.0


def test_a_bump_is_a_bell_that_comes_back_as_it_came():
    bump = {"bump_force": -2e4, "bump_deformation": 0.3, "bump_width": 0.1}
    forces = [value(Bump, d, d_max=0.5, **bump) for d in (-0.1, 0.0, 0.2, 0.3, 0.4)]
    assert forces == pytest.approx([0.0, 0.0, -2e4 / math.e, -2e4, -2e4 / math.e])


def test_a_table_is_unloaded_over_a_length_and_reloaded_along_it():
    table = {"heights": [1e4, -2e4], "reach": 0.6, "unloading_length": 0.1}
    full = value(SmoothTable, 0.45, **table)
    forces = [value(SmoothTable, d, d_max=0.45, **table) for d in (0.45, 0.4, 0.35, 0.2)]
    assert forces == pytest.approx([full, 0.5 * full, 0.0, 0.0])


def test_softening_takes_its_share_over_a_length_and_for_good():
    member = {"softening_deformation": 0.3, "softening_length": 0.2, "loss": 0.6}
    whole, half, all_of_it, after = (value(Softening, 0.1, d_max=deepest, **member) for deepest in (0.3, 0.4, 0.5, 0.9))
    assert [whole, half, all_of_it, after] == pytest.approx([1.0, 0.7, 0.4, 0.4])


def test_a_member_may_tear_smoothly():
    member = {"softening_middle": 0.3, "softening_spread": 0.05, "loss": 0.6}
    factors = [value(SmoothSoftening, 0.1, d_max=deepest, **member) for deepest in (0.0, 0.3, 0.35, 0.9)]
    assert factors == pytest.approx([1.0, 0.7, 0.7 - 0.3 * np.tanh(1.0), 0.4], abs=1e-4)


def test_a_member_may_tear_in_two_steps():
    member = {"softening_deformation": 0.2, "softening_length": 0.1, "loss": 0.3, "step_way": 0.2, "second_loss": 0.2}
    factors = [value(StepwiseSoftening, 0.1, d_max=deepest, **member) for deepest in (0.2, 0.25, 0.35, 0.45, 0.9)]
    assert factors == pytest.approx([1.0, 0.85, 0.7, 0.6, 0.5])
    assert value(StepwiseSoftening, 0.9, **member | {"loss": 0.9}) == 0.0


def test_a_member_may_tear_some_time_after_it_was_deformed_so_far():
    member = {"softening_deformation": 0.3, "loss": 0.6, "delay": 0.004, "duration": 0.002, "slowing": 0.01}
    factors = [DelayedSoftening.force(0.1, 0.0, 0.4, since, **member) for since in (0.0, 0.004, 0.005, 0.02)]
    assert factors == pytest.approx([1.0, 1.0, 0.7, 0.4], abs=1e-3)
    assert [DelayedSoftening.memory_rate(0.1, 0.0, deepest, 0.0, **member) for deepest in (0.2, 0.4)] == [0.0, 1.0]


def test_the_tearing_may_slow_down_as_less_is_left_to_tear():
    member = {"softening_deformation": 0.3, "loss": 0.6, "delay": 0.004, "duration": 0.04, "slowing": 20.0}
    factors = [DelayedSoftening.force(0.1, 0.0, 0.4, since, **member) for since in (0.004, 0.006, 0.01, 0.05)]
    assert factors == pytest.approx([1.0 - 0.6 * (1.0 - np.exp(-since / 0.002)) for since in (0.0, 0.002, 0.006, np.inf)])


def test_a_brake_is_put_on_at_a_time():
    brake = {"friction_force": 5e3, "slip_rate": 0.05, "start": 0.02, "rise": 0.01}
    forces = [Brake.force(0.1, ddot, 0.1, since, **brake) for ddot, since in ((2.0, 0.02), (2.0, 0.025), (-2.0, 0.1))]
    assert forces == pytest.approx([0.0, 2.5e3, -5e3])
    assert Brake.memory_rate(0.1, 0.0, 0.1, 0.0, **brake) == 1.0


def test_a_share_is_lost_on_the_way_back():
    member = {"loss": 0.4, "unloading_length": 0.05}
    factors = [value(UnloadingLoss, d, d_max=0.3, **member) for d in (0.3, 0.25, -10.0)]
    assert factors == pytest.approx([1.0, 1.0 - 0.4 * (1.0 - math.exp(-1.0)), 0.6])


def test_a_member_that_stays_crushed_comes_back_to_its_share():
    member = {"loss": 1.0, "residual_share": 0.6, "unloading_exponent": 2.0}
    factors = [value(ResidualSet, d, d_max=0.5, **member) for d in (0.5, 0.4, 0.3, 0.1)]
    assert factors == pytest.approx([1.0, 0.25, 0.0, 0.0])
    assert value(ResidualSet, 0.0, d_max=0.0, **member) == 1.0


def test_a_share_fades_under_load_and_comes_back_at_rest():
    share, time = 0.4, 0.03
    assert Fading.force(0.1, 0.0, 0.1, 1.0, share, time) == pytest.approx(0.6)
    assert Fading.memory_rate(0.1, 0.0, 0.1, 0.0, share, time) == pytest.approx(1.0 / time)
    assert Fading.memory_rate(0.1, 0.0, 0.1, 1.0, share, time) == 0.0
    assert Fading.memory_rate(-0.1, 0.0, 0.1, 1.0, share, time) == pytest.approx(-1.0 / time)


def test_a_share_of_each_change_of_the_force_fades():
    """A force that rises at once by 1 N, and is gone when half of the fresh share has faded."""
    now = {"fresh_share": 0.4, "relaxation_time": 0.03}
    assert QuasiLinear.force(1.0, 0.0, 1.0, 0.0, **now, holds=0.0) == pytest.approx(1.4)
    assert QuasiLinear.memory_rate(1.0, 0.0, 1.0, 0.0, **now, holds=0.0) == pytest.approx(1.0 / 0.03)
    assert QuasiLinear.force(1.0, 0.0, 1.0, 0.5, **now, holds=0.0) == pytest.approx(1.2)
    assert [QuasiLinear.force(0.0, 0.0, 1.0, 0.5, **now, holds=holds) for holds in (0.0, 1.0)] == pytest.approx([0.0, -0.2])
