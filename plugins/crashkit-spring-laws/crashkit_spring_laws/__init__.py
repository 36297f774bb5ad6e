"""The force laws and rate factors that ship with crashkit."""

from crashkit_spring_laws.buckling import BellPeak, Folding, Peak, PointedPeak
from crashkit_spring_laws.crush_plateau import CrushPlateau
from crashkit_spring_laws.dampers import Viscous, ViscousPower
from crashkit_spring_laws.fracture import Brittle, Fracture, Tear
from crashkit_spring_laws.friction import Coulomb, Dahl, Rubbing
from crashkit_spring_laws.gradual_loss import (
    Fading,
    PlasticShare,
    ResidualSet,
    SecondLine,
    Softening,
    StepwiseSoftening,
    UnloadingLoss,
)
from crashkit_spring_laws.hysteresis import BoucWen
from crashkit_spring_laws.measured_curve import MeasuredCurve
from crashkit_spring_laws.piecewise_affine import PiecewiseAffine
from crashkit_spring_laws.rate_factors import RateEyring, RateLinear, RateLogarithm, RatePower, RateSaturating
from crashkit_spring_laws.relaxation import Maxwell, QuasiLinear
from crashkit_spring_laws.stops import (
    CrushStop,
    ExponentialStop,
    HuntCrossley,
    LinearStop,
    LockingStop,
    Pad,
    QuadraticStop,
    TensionSpring,
)
from crashkit_spring_laws.tables import RateCurve, RateTable, SmoothTable, TimeTable
from crashkit_spring_laws.tie import Tie

SPRING_LAWS = (
    Tie,
    CrushPlateau,
    PiecewiseAffine,
    MeasuredCurve,
    BoucWen,
    RateLinear,
    RatePower,
    RateLogarithm,
    RateSaturating,
    RateEyring,
    Viscous,
    ViscousPower,
    Coulomb,
    Dahl,
    Rubbing,
    Maxwell,
    QuasiLinear,
    LinearStop,
    QuadraticStop,
    LockingStop,
    ExponentialStop,
    CrushStop,
    HuntCrossley,
    Pad,
    TensionSpring,
    Peak,
    PointedPeak,
    BellPeak,
    Folding,
    Fracture,
    Brittle,
    Tear,
    Softening,
    StepwiseSoftening,
    UnloadingLoss,
    ResidualSet,
    PlasticShare,
    SecondLine,
    Fading,
    SmoothTable,
    RateTable,
    TimeTable,
    RateCurve,
)

__all__ = [
    "SPRING_LAWS",
    "BellPeak",
    "BoucWen",
    "Brittle",
    "Coulomb",
    "CrushPlateau",
    "CrushStop",
    "Dahl",
    "ExponentialStop",
    "Fading",
    "Folding",
    "Fracture",
    "HuntCrossley",
    "LinearStop",
    "LockingStop",
    "Maxwell",
    "MeasuredCurve",
    "Peak",
    "PiecewiseAffine",
    "PlasticShare",
    "PointedPeak",
    "QuadraticStop",
    "RateCurve",
    "RateEyring",
    "RateLinear",
    "RateLogarithm",
    "RatePower",
    "RateSaturating",
    "RateTable",
    "Rubbing",
    "SecondLine",
    "SmoothTable",
    "Softening",
    "StepwiseSoftening",
    "Tear",
    "TensionSpring",
    "Tie",
    "TimeTable",
    "UnloadingLoss",
    "Viscous",
    "ViscousPower",
]
