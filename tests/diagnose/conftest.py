"""A mass that runs into a wall at two speeds, seen by film and an accelerometer, and one engine for all tests of diagnosis."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.api import workshop as installed
from crashkit.diagnose import Workshop
from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.misfit.channel import groups_of
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import with_joint
from crashkit.testing import toys

FILM_STD, ACCELEROMETER_STD = 1e-3, 1.0
"""m and m s-2, as the toys state them."""


@pytest.fixture(scope="session")
def workshop() -> Workshop:
    return installed().rehearsed(toys.two_degrees(), [])


@pytest.fixture(scope="session")
def model() -> Model:
    """That springs back as it was crushed would leave sliding through: here it keeps most of its energy."""
    toy = toys.one_degree()
    slope = evolve(toy.parameters()["joint.first.unloading_stiffness"], value=1e6)
    return toy.with_parameters({"joint.first.unloading_stiffness": slope})


@pytest.fixture(scope="session")
def simulated(workshop):
    def run(model, speed=1.0, times=None) -> xr.Dataset:
        times = np.arange(1201) * 2.5e-4 if times is None else times
        return Simulator(model, workshop.laws, workshop.engine).run(times, initial=toys.initial_state(model, speed))

    return run


@pytest.fixture(scope="session")
def recorded(simulated):
    """What instruments record of a model: the stated noise, film at 1 kHz, and whatever else is done to the readings."""

    def record(model, speed=1.0, seed=0, noise=1.0, **changes) -> xr.DataTree:
        clean, random = toys.recording(simulated(model, speed)), np.random.default_rng(seed)
        film = clean["film"].to_dataset(inherit=False).isel(time=slice(None, None, 4))
        felt = clean["accelerometer"].to_dataset(inherit=False)
        film["position"] = film["position"] + noise * random.normal(0.0, FILM_STD, film["position"].shape)
        felt["acceleration"] = felt["acceleration"] + noise * random.normal(0.0, ACCELEROMETER_STD, felt["acceleration"].shape)
        parts = {"film": film, "accelerometer": felt}
        for name, change in changes.items():
            parts[name] = change(parts[name])
        return clean.assign({name: xr.DataTree(part) for name, part in parts.items()})

    return record


@pytest.fixture(scope="session")
def misfit(workshop):
    def make(model, **recordings) -> Misfit:
        return workshop.first_misfit(model, recordings)

    return make


@pytest.fixture(scope="session")
def inquiry(workshop):
    """Into a model, from its best fit, where the questions are real; nobody watches."""

    def into(base, given=None, hypotheses=None) -> Inquiry:
        few = workshop if hypotheses is None else evolve(workshop, hypotheses=hypotheses)
        return Inquiry(few, given or (base and base.misfit), base, lambda doing, share: None)

    return into


@pytest.fixture
def claim(workshop):
    """A claim at the first place where it can be made, at these values, the rest as in a misfit."""

    def make(known, physics, form, **values) -> Rival:
        proposal = next(p for p in propose_all(workshop, known) if (p.physics, p.form) == (physics, form))
        told = {path: value for path in proposal.parameters for name, value in values.items() if path.endswith(name)}
        other = workshop.equipped([proposal.model]).misfit(known, proposal.model).with_values_of(known).with_values(told)
        return Rival(proposal, begin(workshop.identifier, other), 100.0, 50.0)

    return make


@pytest.fixture
def offered(workshop, model, misfit, recorded):
    """A model without a dashpot, and with the one that was proposed, both fitted to two runs of the true one."""

    def offer(damping):
        dashpot = {"damping": damping, "clearance": 0.0, "engagement": 1e-3}
        fixed = {name: Parameter(value, fixed=True) for name, value in dashpot.items()}
        true = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", fixed))
        given = misfit(model, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2))
        base = begin(workshop.identifier, given).advance(40)
        motion = [given.predictor.motion(run, given.values(base.point)) for run in given.recordings]
        kind = workshop.hypotheses["viscous_damping"]()
        proposal = kind.propose(base.fitted().model, motion, list(given.recordings.values()))[0]
        final = begin(workshop.identifier, workshop.misfit(base.fitted(), proposal.model)).advance(40)
        look = Look((Rival(proposal, final, base.deviance - final.deviance, 0.0),), (1.0,), 0.0, base.fitted())
        return look, base, final

    return offer


@pytest.fixture
def watched_in_the_plane(workshop):
    """What a film and an accelerometer tell of a car in the plane that stands still."""
    car = Body("car", (0.0, 0.0), (10.0, 0.0), Parameter(1000.0), inertia=(Parameter(900.0),))
    plane = Model("plane", ("x", "y"), (Body("wall", (5.0, 0.0), (0.0, 0.0), fixed=True), car), ())
    return list(groups_of("run", _in_the_plane(), workshop.observers, plane))


def _in_the_plane():
    """A car that stands still, seen by a marker and felt by a sensor that turns with it."""
    times = np.arange(40) * 1e-3

    def instrument(observer, quantity, units, channel, **attributes):
        values = np.zeros((len(times), 1, 2))
        points = {f"{channel}_body": (channel, ["car"]), f"{channel}_point": ((channel, "axis"), [[0.0, 0.0]], {"units": "m"})}
        read = {quantity: (("time", channel, "axis"), values, {"units": units}), **points}
        coords = {"time": ("time", times, {"units": "s"}), channel: ["one"], "axis": ["x", "y"]}
        return xr.Dataset(read, coords, {"observer": observer, **attributes})

    film = instrument("film", "position", "m", "marker").assign(position_std=("marker", [1e-3], {"units": "m"}))
    sensor = instrument("accelerometer", "acceleration", "m s-2", "sensor", frame="body", channel_frequency_class=0)
    sensor = sensor.assign(acceleration_std=("sensor", [4.0], {"units": "m s-2"}))
    return xr.DataTree.from_dict({"film": film, "accelerometer": sensor})
