"""Every hypothesis keeps the contract; those that need several axes are in test_plane.py."""

import pytest

from crashkit.testing import HypothesisContract
from crashkit_hypotheses import body_forces, buckling, calibration, distortion, parallel_forces
from crashkit_hypotheses.bottoming import Bottoming
from crashkit_hypotheses.carried_load import CarriedLoad
from crashkit_hypotheses.clearance import Clearance
from crashkit_hypotheses.fracture import Fracture
from crashkit_hypotheses.hooks import crashkit_hypotheses
from crashkit_hypotheses.missing_contact import MissingContact
from crashkit_hypotheses.obstacle_motion import ObstacleMotion
from crashkit_hypotheses.plastic_unloading import PlasticUnloading
from crashkit_hypotheses.rate_dependence import RateDependence
from crashkit_hypotheses.relaxation import Relaxation
from crashkit_hypotheses.rotation import Rotation
from crashkit_hypotheses.tension import Tension
from crashkit_hypotheses.unknown import Unknown


class Contract(HypothesisContract):
    """The contract for the class that `kind` names."""

    kind = None

    @pytest.fixture
    def hypothesis(self):
        return self.kind()


class TestAddedMass(Contract):
    kind = body_forces.AddedMass


class TestGroundFriction(Contract):
    kind = body_forces.GroundFriction


class TestBias(Contract):
    kind = calibration.Bias


class TestClockOffset(Contract):
    kind = calibration.ClockOffset


class TestGainError(Contract):
    kind = calibration.GainError


class TestBottoming(Contract):
    kind = Bottoming


class TestCarriedLoad(Contract):
    kind = CarriedLoad


class TestClearance(Contract):
    kind = Clearance


class TestFracture(Contract):
    kind = Fracture


class TestJointFriction(Contract):
    kind = parallel_forces.JointFriction


class TestMissingContact(Contract):
    kind = MissingContact


class TestMountingResonance(Contract):
    kind = distortion.MountingResonance


class TestObstacleMotion(Contract):
    kind = ObstacleMotion


class TestPeakLoad(Contract):
    kind = buckling.PeakLoad


class TestPlasticUnloading(Contract):
    kind = PlasticUnloading


class TestProgressiveFolding(Contract):
    kind = buckling.ProgressiveFolding


class TestRateDependence(Contract):
    kind = RateDependence


class TestRelaxation(Contract):
    kind = Relaxation


class TestSaturation(Contract):
    kind = distortion.Saturation


class TestTension(Contract):
    kind = Tension


class TestRotation(Contract):
    kind = Rotation


class TestUnknown(Contract):
    kind = Unknown


class TestViscousDamping(Contract):
    kind = parallel_forces.ViscousDamping


def test_every_hypothesis_is_under_contract():
    assert {kind.kind for kind in Contract.__subclasses__()} == set(crashkit_hypotheses()) - {
        distortion.Misalignment,
    }
