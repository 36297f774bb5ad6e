import pytest

from crashkit.protocols import Smoother
from crashkit.testing.smoother_contract import SmootherContract
from crashkit_smoothers import AdaptiveQuintic, GcvCubic, GcvHeptic, GcvQuintic, Spectral


class TestAdaptiveQuintic(SmootherContract):
    @pytest.fixture
    def smoother(self) -> Smoother:
        return AdaptiveQuintic()


class TestGcvQuintic(SmootherContract):
    @pytest.fixture
    def smoother(self) -> Smoother:
        return GcvQuintic()


class TestGcvHeptic(SmootherContract):
    @pytest.fixture
    def smoother(self) -> Smoother:
        return GcvHeptic()


class TestGcvCubic(SmootherContract):
    widest = (1.15, 2.0, 8.0)  # to a cubic spline's prior an acceleration has no smoothness at all

    @pytest.fixture
    def smoother(self) -> Smoother:
        return GcvCubic()


class TestSpectral(SmootherContract):
    @pytest.fixture
    def smoother(self) -> Smoother:
        return Spectral()
