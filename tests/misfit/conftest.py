"""The paper's first spring behind film and an accelerometer, and one engine for all tests of diagnosis."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.api import workshop
from crashkit.mechanics import Engine, Simulator
from crashkit.misfit import Misfit
from crashkit.model import InstrumentErrors, Model, Parameter
from crashkit.registry import Registry, load
from crashkit.testing import toys


@pytest.fixture(scope="session")
def registry() -> Registry:
    return load()


@pytest.fixture(scope="session")
def engine() -> Engine:
    return workshop().rehearsed(toys.two_degrees(), []).engine


@pytest.fixture
def model() -> Model:
    return toys.one_degree()


@pytest.fixture
def simulated(registry, engine):
    """The motion of a model at a speed, in the paper's unit."""

    def run(model, times, speed=1.0) -> xr.Dataset:
        simulator = Simulator(model, registry.spring_laws, engine)
        return simulator.run(times, initial=toys.initial_state(model, speed), step=5e-4)

    return run


@pytest.fixture
def recorded(simulated):
    """What perfect instruments record: film at 1 kHz and an accelerometer, both with a stated noise level."""

    def record(model, speed=1.0, end=0.3, interval=1e-3) -> xr.DataTree:
        return toys.recording(simulated(model, np.arange(round(end / interval) + 1) * interval, speed))

    return record


@pytest.fixture
def misfit(registry, engine):
    def make(model, **recordings) -> Misfit:
        return Misfit(model, recordings, registry.spring_laws, registry.observers, engine)

    return make


@pytest.fixture
def with_errors():
    """The model with free errors of one sensor, or of a whole instrument."""

    def add(model, instrument, sensor, **values) -> Model:
        errors = InstrumentErrors(instrument, sensor, {name: Parameter(value) for name, value in values.items()})
        return evolve(model, instruments=(*model.instruments, errors))

    return add


@pytest.fixture
def changed():
    """The recording with one instrument's dataset passed through a function."""

    def change(recording, instrument, function) -> xr.DataTree:
        dataset = function(recording[instrument].to_dataset(inherit=False))
        return recording.assign({instrument: xr.DataTree(dataset)})

    return change
