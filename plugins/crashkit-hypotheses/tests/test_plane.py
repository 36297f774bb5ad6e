"""Models whose bodies turn: every proposal holds together there; a tilted sensor and a turning out of the plane are found."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.api import workshop as installed
from crashkit.diagnose.fitting.search import begin
from crashkit.mechanics import Simulator, compile_engine, functions_of
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.checks import check_model
from crashkit.registry import load
from crashkit.testing import HypothesisContract, hypothesis_contract, toys
from crashkit_hypotheses.body_forces import GroundFriction
from crashkit_hypotheses.carried_load import CarriedLoad
from crashkit_hypotheses.distortion import Misalignment
from crashkit_hypotheses.obstacle_motion import ObstacleMotion
from crashkit_hypotheses.rotation import Rotation

pytestmark = pytest.mark.long

TIMES = np.linspace(0.0, 0.15, 301)
SILENT = {
    "added_mass": "nothing records a force that gives the only mass its scale",
    "missing_contact": "its two bodies are joined already",
    "plastic_unloading": "its rails unload by a slope of their own already",
}
"""Physics that has nothing to propose for the car, and why."""


def rail(name, side, crush_force):
    """Of a car that runs into the face of a wall."""
    values = {"elastic_stiffness": 2e6, "crush_force": crush_force, "densification_deformation": 0.6}
    parameters = {key: Parameter(value, 0.2 * value, 5.0 * value) for key, value in values.items()}
    parameters |= {"densification_stiffness": Parameter(1e6, fixed=True), "unloading_stiffness": Parameter(4e6, fixed=True)}
    absent = ("rate_coefficient", "clearance", "tension")
    parameters |= dict.fromkeys(absent, Parameter(0.0, fixed=True))
    return Joint(name, ("wall", "car"), "crush_plateau", parameters, points=((0.0, 0.0), (1.5, side)), normal=(-1.0, 0.0))


@pytest.fixture(scope="module")
def car():
    """A car whose right rail is the weaker, so that it yaws."""
    inertia = (Parameter(2000.0, fixed=True),)
    wall = Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True)
    car = Body("car", (-1.6, 0.0), (14.0, 0.0), Parameter(1200.0, fixed=True), inertia=inertia)
    return Model("car", ("x", "y"), (wall, car), (rail("left", 0.5, 1.5e5), rail("right", -0.5, 0.7e5)))


@pytest.fixture(scope="module")
def engine(car):
    loaded = CarriedLoad().propose(car, [], [])
    held = ObstacleMotion().propose(car, [pushed(car)], [])
    models = [car, *(proposal.model for proposal in (*loaded, *held))]
    return compile_engine({f for one in models for f in functions_of(one, load().spring_laws)}, axes=2)


def pushed(model):
    """A motion in which both rails bear a force."""
    names = [joint.name for joint in model.joints]
    return xr.Dataset({"force": (("time", "joint"), np.full((2, len(names)), 1e5))}, coords={"joint": names})


@pytest.fixture(scope="module")
def crash(car, engine):
    return Simulator(car, load().spring_laws, engine).run(TIMES)


@pytest.fixture(scope="module")
def recorded(crash):
    """The accelerometer turns with the car."""
    recording = toys.recording(crash)
    sensors = recording["accelerometer"].to_dataset(inherit=False).assign_attrs(frame="body")
    return recording.assign({"accelerometer": xr.DataTree(sensors)})


class TestMisalignment(HypothesisContract):
    @pytest.fixture
    def hypothesis(self):
        return Misalignment()

    @pytest.fixture
    def model(self, car):
        return car

    @pytest.fixture
    def motion(self, crash):
        return [crash]

    @pytest.fixture
    def recordings(self, recorded):
        return {"run": recorded}

    @pytest.fixture(autouse=True)
    def _one_engine(self, engine, monkeypatch):
        monkeypatch.setattr(hypothesis_contract, "_engine", lambda models: engine)


def test_the_car_yaws(crash):
    assert float(np.abs(crash["angular_velocity"]).max()) > 0.5


@pytest.mark.parametrize("physics", sorted(load().hypotheses))
def test_every_proposal_holds_together_in_the_plane(car, crash, recorded, physics):
    registry = load()
    proposals = registry.hypotheses[physics]().propose(car, [crash], [recorded])
    assert bool(proposals) != (physics in SILENT)
    for proposal in proposals:
        check_model(proposal.model, registry.spring_laws, physics, registry.observers)


def test_a_load_presses_forward_on_its_carrier(car, engine, crash):
    tied = CarriedLoad().propose(car, [crash], [])[0]
    run = Simulator(tied.model.with_values(tied.starts[-1]), load().spring_laws, engine).run(TIMES)
    assert float(run["deformation"].sel(joint=tied.model.joints[-1].name).max()) > 1e-3
    assert float(run["position"].sel(body="car", axis="x").max()) > float(crash["position"].sel(body="car", axis="x").max())


def test_an_obstacle_that_slides_is_pushed_ahead(car, engine, crash):
    sliding = next(p for p in ObstacleMotion().propose(car, [crash], []) if p.form == "sliding")
    run = Simulator(sliding.model.with_values(sliding.starts[0]), load().spring_laws, engine).run(TIMES)
    assert float(run["position"].sel(body="wall", axis="x")[-1]) > 0.02
    assert float(np.abs(run["position"].sel(body="wall", axis="y")).max()) < 0.01


def test_the_ground_brakes_a_car_across_its_way_too(car, engine, crash):
    forms = {proposal.form: proposal for proposal in GroundFriction().propose(car, [crash], [])}
    moved = {}
    for form in ("constant", "constant, across too"):
        braked = forms[form].model.with_values(dict.fromkeys(forms[form].parameters, 2e4))
        moved[form] = Simulator(braked, load().spring_laws, engine).run(TIMES)["position"].sel(body="car").isel(time=-1)
    along, across = moved["constant"], moved["constant, across too"]
    assert abs(float(across.sel(axis="y"))) < 0.5 * abs(float(along.sel(axis="y")))
    assert float(across.sel(axis="x")) == pytest.approx(float(along.sel(axis="x")), abs=0.02)


def test_on_a_line_a_tilted_sensor_also_reads_gravity():
    toy = toys.two_degrees()
    run = toys.recording(Simulator(toy, load().spring_laws).run(TIMES))
    tilted = {p.location["sensor"]: p for p in Misalignment().propose(toy, [], [run])}
    assert {p.form for p in tilted.values()} == {"lean"}
    assert tilted["front_sensor"].parameters == tuple(
        f"instrument.accelerometer.front_sensor.{name}" for name in ("lean", "bias")
    )


def leaning_across(toy, swaying, lean=0.3):
    """A sensor that leans, with a channel across; or one that stands, on a body that moves across as well."""
    run = toys.recording(Simulator(toy, load().spring_laws).run(TIMES))
    group = run["accelerometer"].to_dataset(inherit=False)
    felt = group["acceleration"].sel(axis="x")
    sway = 40.0 * np.sin(2.0 * np.pi * 60.0 * felt["time"]) if swaying else 0.0
    angle = xr.where(group["sensor"] == ("" if swaying else "front_sensor"), lean, 0.0)
    both = xr.concat([np.cos(angle) * felt, np.sin(angle) * felt + sway], dim=xr.Variable("axis", ["x", "z"]))
    across = group["sensor_point"].reindex(axis=["x", "z"], fill_value=0.0)
    group = group.drop_dims("axis").assign(acceleration=both.assign_attrs(felt.attrs), sensor_point=across)
    return run.assign({"accelerometer": xr.DataTree(group)})


def test_on_a_line_another_axis_tells_how_far_a_sensor_leans():
    toy = toys.two_degrees()
    told = [p for p in Misalignment().propose(toy, [], [leaning_across(toy, False)]) if p.form == "lean, told across"]
    assert [p.location["sensor"] for p in told] == ["front_sensor"]
    assert told[0].starts[0]["instrument.accelerometer.front_sensor.lean"] == pytest.approx(0.3, abs=1e-6)
    assert told[0].odds > 1.0


def test_a_sensor_whose_axes_have_changed_places_does_not_lean():
    toy = toys.two_degrees()
    forms = {p.form for p in Misalignment().propose(toy, [], [leaning_across(toy, False, lean=1.5)])}
    assert forms == {"lean"}


def test_a_body_that_sways_is_no_sensor_that_leans():
    toy = toys.two_degrees()
    forms = {p.form for p in Misalignment().propose(toy, [], [leaning_across(toy, True)])}
    assert forms == {"lean"}


def test_a_tilted_sensor_is_found(car, crash, engine, recorded):
    registry, workshop = load(), evolve(installed(), engine=engine)
    group = recorded["accelerometer"].to_dataset(inherit=False)
    felt = registry.observers["accelerometer"]().predict(crash, group, {"car_sensor": {"tilt_z": 0.1}})["acceleration"]
    noise = np.random.default_rng(1).normal(0.0, 1.0, felt.shape)
    recording = recorded.assign({"accelerometer": xr.DataTree(group.assign(acceleration=felt + noise))})
    given = workshop.first_misfit(car, {"run": recording})
    fits = {
        proposal.form: begin(workshop.identifier, workshop.misfit(given, proposal.model)).advance(6)
        for proposal in Misalignment().propose(car, [crash], [recording])
    }
    assert fits["tilt"].deviance < fits["transverse"].deviance + 10.0
    tilt = fits["tilt"].result().parameters.sel(parameter="instrument.accelerometer.car_sensor.tilt_z")
    assert abs(float(tilt["value"]) - 0.1) < 5.0 * float(tilt["std"]) < 0.05


def pitching(car):
    """The same car in space: its rails stand beneath its centre of mass, so that it also pitches."""
    inertia = tuple(Parameter(value, fixed=True) for value in (500.0, 3000.0, 2000.0))
    wall, body = (
        evolve(one, position=(*one.position, 0.0), velocity=(*one.velocity, 0.0), inertia=inertia) for one in car.bodies
    )
    rails = tuple(
        evolve(joint, points=((*joint.points[0], -0.05), (*joint.points[1], -0.05)), normal=(-1.0, 0.0, 0.0))
        for joint in car.joints
    )
    return Model("car", ("x", "y", "z"), (wall, body), rails)


def test_a_turning_that_the_plane_leaves_out_is_found(car, crash, engine):
    motion = Simulator(pitching(car), load().spring_laws).run(TIMES)
    high = xr.DataArray([[0.0, 0.0, 1.0]], dims=("sensor", "axis"))
    group = toys.recording(motion)["accelerometer"].to_dataset(inherit=False).isel(sensor=[-1])
    group = group.assign(sensor_point=high.assign_coords(group[["sensor", "axis"]].coords)).assign_attrs(frame="body")
    felt = load().observers["accelerometer"]().predict(motion, group, {})["acceleration"]
    noise = np.random.default_rng(1).normal(0.0, 1.0, felt.shape)
    seen = group.assign(acceleration=felt + noise).sel(axis=["x", "y"])
    recording = toys.recording(crash).drop_nodes("film").assign(accelerometer=xr.DataTree(seen))
    workshop = evolve(installed(), engine=engine)
    given = workshop.first_misfit(car, {"run": recording})
    (proposal,) = Rotation().propose(car, [crash], [recording])
    before = begin(workshop.identifier, given).advance(6).deviance
    models = [proposal.model.with_values(start) for start in proposal.starts]
    fits = [begin(workshop.identifier, workshop.misfit(given, model)).advance(30) for model in models]
    after = min(fits, key=lambda fit: fit.deviance)
    assert after.deviance < before - 1000.0
    share = after.result().parameters.sel(parameter="instrument.accelerometer.car_sensor/x.rocking_share")
    # The lever times the height over the square of the radius of gyration.
    assert float(share["value"]) == pytest.approx(0.05 * 1.0 / (3000.0 / 1200.0), abs=0.01)
