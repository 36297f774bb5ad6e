"""The law keeps the contract of spring laws."""

import pytest

from crashkit.testing import SpringLawContract
from crashkit_example_law.hardening import Hardening


class TestHardening(SpringLawContract):
    @pytest.fixture(params=[0.0, 0.5], ids=["lossless", "lossy"])
    def parameters(self, request):
        return {"stiffness": 1e5, "hardening": 2e6, "loss": request.param}

    @pytest.fixture
    def law(self):
        return Hardening
