"""What a given noise does, and what happens where the samples contradict it."""

import numpy as np
import pytest
import xarray as xr

from crashkit.protocols import Smoother
from crashkit.testing.smoother_contract import channel, noisy, rms, stop
from crashkit_smoothers import AdaptiveQuintic, GcvCubic, GcvHeptic, GcvQuintic, Spectral

EVERY = [AdaptiveQuintic(), GcvCubic(), GcvHeptic(), GcvQuintic(), Spectral()]
TIMES, (POSITION, _, ACCELERATION) = stop(np.linspace(0.0, 0.14, 300))


def smoothed(smoother: Smoother, std: float | None) -> xr.Dataset:
    return smoother.smooth(channel(TIMES, noisy(POSITION, 7)), std)


@pytest.mark.parametrize("smoother", EVERY, ids=lambda smoother: smoother.name)
def test_a_noise_that_the_samples_show_is_believed(smoother: Smoother) -> None:
    smooth = smoothed(smoother, 1e-3)
    assert smooth.attrs["noise_std"] == 1e-3
    assert "samples show" not in smooth.attrs["choice"]


@pytest.mark.parametrize("share", [0.03, 0.3, 0.7])
@pytest.mark.parametrize("smoother", EVERY, ids=lambda smoother: smoother.name)
def test_a_noise_that_is_too_small_is_not_believed(smoother: Smoother, share: float) -> None:
    smooth, unknown = smoothed(smoother, share * 1e-3), smoothed(smoother, None)
    assert f"the samples show {unknown.attrs['noise_std'] / (share * 1e-3):.2g} times" in smooth.attrs["choice"]
    assert "which is used instead" in smooth.attrs["choice"]
    xr.testing.assert_allclose(smooth, unknown, rtol=1e-2, atol=1e-6)


@pytest.mark.parametrize("smoother", EVERY, ids=lambda smoother: smoother.name)
def test_a_noise_that_is_too_large_is_used_and_told(smoother: Smoother) -> None:
    smooth = smoothed(smoother, 2e-3)
    assert smooth.attrs["noise_std"] == 2e-3
    assert "; the samples show only 0.4" in smooth.attrs["choice"]
    assert rms(smooth["second_derivative"].values - ACCELERATION) < 30.0
