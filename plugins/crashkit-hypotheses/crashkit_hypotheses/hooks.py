"""Registers the hypotheses."""

from crashkit.protocols import Hypothesis
from crashkit.registry import hookimpl
from crashkit_hypotheses.body_forces import AddedMass, GroundFriction
from crashkit_hypotheses.bottoming import Bottoming
from crashkit_hypotheses.buckling import PeakLoad, ProgressiveFolding
from crashkit_hypotheses.calibration import Bias, ClockOffset, GainError
from crashkit_hypotheses.carried_load import CarriedLoad
from crashkit_hypotheses.clearance import Clearance
from crashkit_hypotheses.distortion import Misalignment, MountingResonance, Saturation
from crashkit_hypotheses.fracture import Fracture
from crashkit_hypotheses.missing_contact import MissingContact
from crashkit_hypotheses.obstacle_motion import ObstacleMotion
from crashkit_hypotheses.parallel_forces import JointFriction, ViscousDamping
from crashkit_hypotheses.plastic_unloading import PlasticUnloading
from crashkit_hypotheses.rate_dependence import RateDependence
from crashkit_hypotheses.relaxation import Relaxation
from crashkit_hypotheses.rotation import Rotation
from crashkit_hypotheses.tension import Tension
from crashkit_hypotheses.unknown import Unknown


@hookimpl
def crashkit_hypotheses() -> list[type[Hypothesis]]:
    """The hypotheses of this distribution."""
    return [
        AddedMass,
        Bias,
        Bottoming,
        CarriedLoad,
        Clearance,
        ClockOffset,
        Fracture,
        GainError,
        GroundFriction,
        JointFriction,
        Misalignment,
        MissingContact,
        MountingResonance,
        ObstacleMotion,
        PeakLoad,
        PlasticUnloading,
        ProgressiveFolding,
        RateDependence,
        Relaxation,
        Rotation,
        Saturation,
        Tension,
        Unknown,
        ViscousDamping,
    ]
