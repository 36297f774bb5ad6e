"""A sensor that recorded nothing in one run is left out of it; an instrument that recorded nothing is refused."""

import re

import numpy as np
import pytest

from crashkit.data import check_recording
from crashkit.data.silent import left_out_of, without_silent
from crashkit.errors import ContractError
from crashkit.registry import load

OBSERVERS = load().observers
SCHEMAS = {name: observer.schema for name, observer in OBSERVERS.items()}


def test_a_marker_that_is_hidden_throughout_is_left_out(recording):
    recording["film"].position[:, 0] = np.nan
    check_recording(recording, SCHEMAS, "run.nc")
    told = 'run.nc: film/position: only NaN of "m1"; left out'
    with pytest.warns(UserWarning, match=re.escape(told)):
        heard = without_silent("run.nc", recording, OBSERVERS)
    assert heard["film"]["marker"].values.tolist() == ["m2"]
    assert heard["film"]["marker_body"].values.tolist() == ["body"]
    assert heard["accelerometer"].identical(recording["accelerometer"])
    assert left_out_of(heard) == left_out_of(without_silent("run.nc", heard, OBSERVERS)) == [told]
    assert left_out_of(recording) == []


def test_what_all_sensors_recorded_stays_as_it_is(recording):
    recording["film"].position[1, 0] = np.nan
    assert without_silent("run.nc", recording, OBSERVERS).identical(recording)


def test_an_instrument_of_an_observer_that_is_not_installed_stays_as_it_is(recording):
    recording["film"].position[:, 0] = np.nan
    assert without_silent("run.nc", recording, {}).identical(recording)


def test_an_instrument_that_recorded_nothing_is_refused(recording):
    recording["film"].position[:] = np.nan
    told = 'film/position: expected a value in every channel, found only NaN at marker "m1", axis "x"'
    with pytest.raises(ContractError, match=re.escape(told)):
        check_recording(recording, SCHEMAS, "run.nc")


def test_what_was_left_out_of_several_instruments_is_told_of_each(recording):
    recording["film"].position[:, 0] = np.nan
    recording["accelerometer"].acceleration[:, 0] = np.nan
    with pytest.warns(UserWarning, match="only NaN of"):
        heard = without_silent("run.nc", recording, OBSERVERS)
    sensor = recording["accelerometer"]["sensor"].values[0]
    assert left_out_of(heard) == [
        'run.nc: film/position: only NaN of "m1"; left out',
        f'run.nc: accelerometer/acceleration: only NaN of "{sensor}"; left out',
    ]
