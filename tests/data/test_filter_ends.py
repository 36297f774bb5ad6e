"""A record whose filter was not told of the rest before it is not believed at its ends."""

import numpy as np
import pytest
import xarray as xr
from scipy.signal import butter, filtfilt

from crashkit.data.channel_filter import DESIGN_FREQUENCY, filter_channel
from crashkit.data.filter_ends import UNSETTLED, unsettled

RATE = 10_000.0
TIMES = np.arange(0.0, 0.12, 1.0 / RATE)
SETTLED = {60: 0.01084, 180: 0.00361}


def pulse(times, begins=0.0):
    """Newtons: a joint that is met there, crushed after 2 ms, and let go."""
    return 2e4 * np.interp(times - begins, [0.0, 0.002, 0.05, 0.06], [0.0, 1.0, 1.0, 0.0])


def record(force, times=TIMES, cfc=180, std=50.0):
    noise = np.random.default_rng(1).normal(0.0, std or 1.0, len(times))
    wall = xr.Dataset(
        {"force": (("time", "sensor", "axis"), (force + noise)[:, None, None])},
        {"time": times, "sensor": ["wall"], "axis": ["x"]},
        {"channel_frequency_class": cfc},
    )
    return wall.assign(force_std=("sensor", [std])) if std else wall


def by_scipy(force, cfc):
    """As most programs filter a record: continued at both ends, mirrored in its first and last sample."""
    return filtfilt(*butter(2, DESIGN_FREQUENCY * cfc, fs=RATE), force)


@pytest.mark.parametrize("cfc", [60, 180])
@pytest.mark.parametrize("std", [50.0, None])
def test_a_filter_that_knows_only_the_record_has_made_up_its_ends(cfc, std):
    assert unsettled(record(by_scipy(pulse(TIMES), cfc), cfc=cfc, std=std), "force") == pytest.approx(SETTLED[cfc], abs=1e-5)


@pytest.mark.parametrize("cfc", [60, 180])
@pytest.mark.parametrize("std", [50.0, None])
def test_one_that_was_told_of_the_rest_before_has_not(cfc, std):
    assert unsettled(record(filter_channel(pulse(TIMES), TIMES, cfc, before=0.0), cfc=cfc, std=std), "force") == 0.0


@pytest.mark.parametrize("times", [TIMES - 0.02, TIMES])
def test_nor_has_one_where_little_happens_at_first(times):
    """The record holds the rest before, or the joint is met later: there is nothing that the two would show otherwise."""
    begins = 0.0 if times[0] < 0.0 else 0.02
    assert unsettled(record(by_scipy(pulse(times, begins), 180), times), "force") == 0.0


def test_what_is_not_filtered_or_is_all_ends_is_believed():
    assert unsettled(record(pulse(TIMES), cfc=0), "force") == 0.0
    short = TIMES[:60]
    assert unsettled(record(by_scipy(pulse(short), 180), short), "force") == 0.0
    assert unsettled(record(pulse(short)[:1], short[:1]), "force") == 0.0


def test_what_was_looked_at_is_not_looked_at_again():
    thin = record(by_scipy(pulse(TIMES), 180)).isel(time=slice(None, None, 5))
    assert unsettled(thin.assign_attrs({UNSETTLED: 0.0}), "force") == 0.0
    assert unsettled(thin.assign_attrs({UNSETTLED: 0.004}), "force") == 0.004


@pytest.mark.parametrize("cfc", [60, 180])
def test_beyond_them_both_filters_say_the_same(cfc):
    told, untold = filter_channel(pulse(TIMES), TIMES, cfc, before=0.0), by_scipy(pulse(TIMES), cfc)
    apart = np.abs(told - untold)
    ends = unsettled(record(untold, cfc=cfc), "force")
    inside = (ends <= TIMES) & (TIMES[-1] - ends >= TIMES)
    assert apart.max() > 100.0
    assert apart[inside].max() < 0.005 * apart.max()
