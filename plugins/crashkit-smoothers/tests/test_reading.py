import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.testing.smoother_contract import channel
from crashkit_smoothers import GcvQuintic


def test_too_few_samples_are_refused() -> None:
    samples = channel(np.arange(8.0), np.array([0.0, 1.0, np.nan, 2.0, np.nan, 1.0, np.nan, 0.0]))
    with pytest.raises(CrashkitError, match="gcv_quintic: expected at least 6 samples, found 5"):
        GcvQuintic().smooth(samples)


def test_a_filter_leaves_too_few_independent_samples() -> None:
    samples = channel(np.arange(100) * 1e-4, np.zeros(100)).assign_attrs(channel_frequency_class=60)
    with pytest.raises(CrashkitError, match=r"expected at least 6 samples, found 2\.\d+ independent ones \(CFC60\)"):
        GcvQuintic().smooth(samples)


def test_times_that_do_not_increase_are_refused() -> None:
    with pytest.raises(CrashkitError, match="expected increasing times, found 2 s before 1.5 s"):
        GcvQuintic().smooth(channel(np.array([0.0, 1.0, 2.0, 1.5, 3.0, 4.0, 5.0]), np.zeros(7)))


def test_a_channel_has_one_dimension() -> None:
    with pytest.raises(CrashkitError, match=r"expected samples over time with its coordinate, found dims \('time', 'axis'\)"):
        GcvQuintic().smooth(xr.DataArray(np.zeros((9, 2)), {"time": np.arange(9.0)}, ("time", "axis")))


@pytest.mark.parametrize("std", [0.0, -1.0, np.nan])
def test_a_standard_deviation_is_positive(std: float) -> None:
    with pytest.raises(CrashkitError, match=f"expected standard deviations above 0, found {std}"):
        GcvQuintic().smooth(channel(np.arange(9.0), np.zeros(9)), std=std)
