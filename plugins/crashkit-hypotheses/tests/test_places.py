"""Where the hypotheses see a place for their physics, and where they do not."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.mechanics import Simulator
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_factor, with_instrument_error, with_joint
from crashkit.registry import load
from crashkit.testing import toys

DRIVEN = "deformation of another joint"
FIXED = Parameter(0.0, fixed=True)


@pytest.fixture(scope="module")
def model():
    toy = toys.two_degrees()
    return toy.with_parameters({"body.rear.mass": evolve(toy.parameters()["body.rear.mass"], fixed=True)})


@pytest.fixture(scope="module")
def runs(model, engine):
    simulator = Simulator(model, load().spring_laws, engine)
    return [simulator.run(np.linspace(0.0, 1.0, 501), initial=toys.initial_state(model, speed)) for speed in (1.0, 2.0)]


@pytest.fixture
def propose(model, runs):
    """The proposals of a physics for the toy, or for one like it."""

    def ask(physics, other=None, motion=None, recordings=None):
        motion = runs if motion is None else motion
        recordings = [toys.recording(run) for run in runs] if recordings is None else recordings
        return load().hypotheses[physics]().propose(other or model, motion, recordings)

    return ask


def places(proposals):
    return {tuple(sorted((key, str(value)) for key, value in p.location.items())) for p in proposals}


BOTH_JOINTS = {(("joint", "first"),), (("joint", "second"),)}
MOVING = {(("body", "front"),), (("body", "rear"),)}
PLACES = {
    "added_mass": MOVING,
    "ground_friction": MOVING,
    "carried_load": MOVING,
    "bottoming": BOTH_JOINTS,
    "fracture": BOTH_JOINTS,
    "relaxation": BOTH_JOINTS,
    "obstacle_motion": {(("body", "wall"),)},
    "clearance": BOTH_JOINTS,
    "joint_friction": BOTH_JOINTS,
    "peak_load": BOTH_JOINTS,
    "plastic_unloading": BOTH_JOINTS,
    "progressive_folding": BOTH_JOINTS,
    "rate_dependence": BOTH_JOINTS,
    "unknown": BOTH_JOINTS | {(("body", "front"),), (("body", "rear"),), (("bodies", "['wall', 'rear']"),)},
    "viscous_damping": BOTH_JOINTS,
    "missing_contact": {(("bodies", "['wall', 'rear']"),)},
    "clock_offset": {(("instrument", "film"),), (("instrument", "accelerometer"),)},
    "gain_error": {
        (("instrument", instrument), ("sensor", f"{body}_{channel}"))
        for instrument, channel in (("film", "marker"), ("accelerometer", "sensor"))
        for body in ("front", "rear")
    },
}
PLACES["bias"] = PLACES["gain_error"]
PLACES["saturation"] = PLACES["mounting_resonance"] = {
    (("instrument", "accelerometer"), ("sensor", f"{body}_sensor")) for body in ("front", "rear")
}


@pytest.mark.parametrize("physics", PLACES)
def test_every_place_is_proposed(propose, physics):
    assert places(propose(physics)) == PLACES[physics]


def test_what_one_joint_does_in_another_is_deformed_like_the_one_and_pushes_like_the_other(propose):
    """Apart, whichever of the other's bodies is named first."""
    toy = toys.two_degrees()
    turned = evolve(toy, joints=(toy.joint("first"), evolve(toy.joint("second"), bodies=("rear", "front"))))
    for model in (toy, turned):
        links = {p.form: p.model.joints[-1] for p in propose("unknown", model) if p.estimate_of == DRIVEN}
        forms = {f"deformation of {name}{how}" for name in ("first", "second") for how in ("", ", as a factor")}
        assert set(links) == forms
        assert links["deformation of first"].bodies == ("wall", "front")
        assert links["deformation of first"].acts_on == ("front", "rear")
        factor = links["deformation of first, as a factor"]
        assert (factor.name, factor.factors, factor.driver) == ("second", ("driven_curve",), "first")


@pytest.mark.parametrize(("physics", "form"), [("progressive_folding", "shaped"), ("peak_load", "bell")])
def test_a_force_that_a_law_takes_in_is_also_proposed_beside_it(propose, physics, form):
    """Where it stands beside the law anyway, only once."""
    toy = toys.two_degrees()
    forms = {p.form: p for p in propose(physics, toy) if p.location == {"joint": "first"}}
    within, apart = forms[form], forms[f"{form}, beside"]
    assert [joint.name for joint in within.model.joints] == ["first", "second"]
    assert [joint.name for joint in apart.model.joints] == ["first", "second", f"first_{physics}"]
    assert (within.refined, apart.refined) == (form == "bell", True)
    taken = evolve(toy.joint("first"), law="linear_stop", parameters={"stiffness": FIXED, "stop_deformation": FIXED})
    alone = evolve(toy, joints=(taken, toy.joint("second")))
    forms = [p.form for p in propose(physics, alone) if p.location == {"joint": "first"}]
    assert form in forms and f"{form}, beside" not in forms


@pytest.mark.parametrize(
    ("physics", "form", "known", "law"),
    [
        ("joint_friction", "smooth, only pushing", "crush_plateau + folding", "crush_plateau + folding & coulomb"),
        ("progressive_folding", "shaped", "crush_plateau & coulomb", "crush_plateau + folding & coulomb"),
        ("viscous_damping", "linear, only pushing", "crush_plateau & coulomb", None),
    ],
)
def test_folds_and_friction_that_only_push_together_stand_in_one_joint_in_whichever_order(propose, physics, form, known, law):
    """And nothing more stands beside these."""
    toy = toys.two_degrees()
    first = evolve(toy.joint("first"), law=known)
    laws = {
        p.form: p.model.joint("first").law
        for p in propose(physics, evolve(toy, joints=(first, toy.joint("second"))))
        if p.location == {"joint": "first"}
    }
    assert laws.get(form) == law


def test_joints_of_the_same_two_bodies_do_nothing_in_each_other(propose, runs):
    toy = toys.two_degrees()
    beside = evolve(toy, joints=(toy.joint("second"), evolve(toy.joint("second"), name="first")))
    assert not [p for p in propose("unknown", beside, runs) if p.estimate_of == DRIVEN]


def test_a_mass_without_any_force_is_only_a_scale(propose):
    """One moving body, no load cell: twice the mass and twice the forces move alike."""
    alone = toys.one_degree()
    assert propose("added_mass", alone, [], []) == []
    dataset = {"force": (("time", "sensor", "axis"), np.zeros((3, 1, 1)))}
    wall = xr.DataTree.from_dict({"cell": xr.Dataset(dataset)})
    assert places(propose("added_mass", alone, [], [wall])) == {(("body", "front"),)}


def test_a_mass_that_is_identified_already_is_not_doubted(propose):
    """And then the other mass is the scale of all forces."""
    assert propose("added_mass", toys.two_degrees()) == []


def test_a_mass_that_was_weighed_is_doubted_within_its_bounds(model, propose):
    weighed = model.parameters()["body.rear.mass"].value

    def claimed(lower, upper):
        bounded = model.with_parameters({"body.rear.mass": Parameter(weighed, lower, upper, fixed=True)})
        proposals = {p.location["body"]: p.model.parameters()["body.rear.mass"] for p in propose("added_mass", bounded)}
        return (proposals["rear"].lower, proposals["rear"].upper) if "rear" in proposals else None

    assert claimed(0.99 * weighed, 1.01 * weighed) == (0.99 * weighed, 1.01 * weighed)
    assert claimed(0.99 * weighed, np.inf) == (0.99 * weighed, 3.0 * weighed)
    assert claimed(weighed, weighed) is None


def test_a_joint_that_is_never_compressed_hides_nothing(propose, runs):
    still = [run.assign(deformation=run["deformation"] * [1.0, 0.0]) for run in runs]
    pressed = ("bottoming", "peak_load", "viscous_damping", "joint_friction", "unknown", "plastic_unloading", "relaxation")
    for physics in pressed:
        of_joints = {place for place in places(propose(physics, motion=still)) if place[0][0] == "joint"}
        assert of_joints == {(("joint", "first"),)}, physics


def test_an_unknown_force_is_one_on_a_body_where_it_differs_from_one_in_its_mount(propose, runs):
    """The front is held by the wall: only a load cell tells what pushes it from what its joint does. One of the time is there
    for the comparison, and rather it than one in the joint."""
    cells = [toys.recording(run).assign(load_cell=xr.DataTree(xr.Dataset({"force": ("time", [0.0])}))) for run in runs]
    bodies = [
        {p.location["body"] for p in one if "body" in p.location and not p.refined}
        for one in (propose("unknown"), propose("unknown", recordings=cells))
    ]
    assert bodies == [{"rear"}, {"front", "rear"}]
    (compared,) = [p for p in propose("unknown") if p.location == {"body": "front"}]
    assert (compared.form, compared.refined, compared.odds) == ("time", True, 1.0)
    odds = [
        {p.location["joint"]: p.odds for p in one if p.form == "time" and "joint" in p.location}
        for one in (propose("unknown"), propose("unknown", recordings=cells))
    ]
    assert odds == [{"first": 0.5, "second": 1.0}, {"first": 1.0, "second": 1.0}]


def test_a_force_of_the_time_may_be_larger_where_several_runs_have_it_in_common(propose, runs):
    """No law of the model could explain it; in one run any of them could."""
    sizes = []
    for motion in (runs[:1], [*runs[:1]] * 2):
        (timed,) = [p for p in propose("unknown", motion=motion) if p.form == "time" and p.location == {"joint": "first"}]
        sizes.append(timed.model.parameters()[timed.parameters[0]].size)
    assert sizes[1] == pytest.approx(3.0 * sizes[0])


def test_a_strap_needs_a_joint_that_was_stretched_a_hook_one_that_sprang_back_and_a_line_one_that_does_not_pull(
    propose, runs, model
):
    pressed = [run.assign(deformation=np.maximum(run["deformation"], 0.0)) for run in runs]
    assert places(propose("tension")) == BOTH_JOINTS
    always = {"own line", "own line, to a limit", "hook", "hook, yielding"}
    assert {p.form for p in propose("tension")} == {*always, "strap", "strap, yielding"}
    assert {p.form for p in propose("tension", motion=pressed)} == always
    pulls = model.with_parameters({"joint.first.tension": Parameter(1.0, fixed=True)})
    assert places(propose("tension", pulls, pressed)) == {(("joint", "second"),)}


def test_bodies_that_are_joined_or_never_come_closer_do_not_touch_anew(propose, model, runs):
    joined = with_joint(
        model, Joint("third", ("rear", "wall"), "linear_stop", {"stiffness": FIXED, "stop_deformation": FIXED})
    )
    assert propose("missing_contact", joined) == []
    apart = [run.isel(time=[0, 0]) for run in runs]
    assert propose("missing_contact", motion=apart) == []


@pytest.mark.parametrize("physics", ["clearance", "plastic_unloading"])
def test_what_the_model_has_already_is_not_proposed(propose, model, physics):
    name = {"clearance": "clearance", "plastic_unloading": "unloading_stiffness"}[physics]
    has = model.with_parameters({f"joint.first.{name}": Parameter(0.05, 0.0, 1e9)})
    assert places(propose(physics, has)) == {(("joint", "second"),)}


@pytest.mark.parametrize(("loss", "forms"), [(0.0, {"fading"}), (0.5, set())])
def test_a_joint_that_knows_no_slope_of_unloading_may_lose_force_on_the_way_back(propose, model, loss, forms):
    """Unless it does."""
    rubber = {"stiffness": Parameter(1e5), "hardening": FIXED, "loss": Parameter(loss, fixed=True)}
    has = evolve(model, joints=(evolve(model.joints[0], law="hardening", parameters=rubber), model.joints[1]))
    motion = [Simulator(has, load().spring_laws).run(np.linspace(0.0, 1.0, 501), initial=toys.initial_state(has, 1.0))]
    proposed = propose("plastic_unloading", has, motion)
    assert {one.form for one in proposed if one.location == {"joint": "first"}} == forms


def test_a_joint_with_a_rate_factor_takes_no_other(propose, model):
    has = evolve(model, joints=(evolve(model.joints[0], factors=("rate_linear",)), model.joints[1]))
    assert places(propose("rate_dependence", has)) == {(("joint", "second"),)}


def test_a_joint_that_breaks_already_may_also_depend_on_rate_and_does_not_break_twice(propose, model):
    broken = {"fracture_deformation": Parameter(0.3), "loss": Parameter(0.5)}
    has = with_factor(model, "first", "fracture", broken)
    assert places(propose("rate_dependence", has)) == BOTH_JOINTS
    assert places(propose("fracture", has)) == {(("joint", "second"),)}


def test_a_joint_tears_only_where_it_pulls(propose, model, engine):
    pressed = {"compression", "smoothly", "in two steps", "delayed", "of its loading curve"}
    assert {p.form for p in propose("fracture")} == pressed
    pulling = model.with_parameters({"joint.first.tension": Parameter(1.0, fixed=True)})
    motion = [Simulator(pulling, load().spring_laws, engine).run(np.linspace(0.0, 1.0, 501))]
    tears = [p for p in propose("fracture", pulling, motion) if p.form == "tear"]
    assert places(tears) == {(("joint", "first"),)}


def test_an_obstacle_that_nothing_presses_on_does_not_move(propose, runs):
    still = [run.assign(force=run["force"] * [0.0, 1.0]) for run in runs]
    assert propose("obstacle_motion", motion=still) == []


def test_how_fast_an_obstacle_must_slide_is_only_sought_where_sliding_leads(propose):
    forms = {proposal.form: proposal for proposal in propose("obstacle_motion")}
    plain, slow = forms["sliding"], forms["sliding slowly"]
    assert [path.rsplit(".", 1)[1] for path in plain.parameters] == ["mass", "friction_force"]
    assert [path.rsplit(".", 1)[1] for path in slow.parameters] == ["mass", "friction_force", "slip_rate"]
    assert (plain.refined, slow.refined) == (False, True)


def test_what_holds_an_obstacle_is_not_felt_by_a_load_cell_on_it(propose):
    held = propose("obstacle_motion")
    forms = ["free", "sliding", "sliding slowly", "sprung", "sprung and sliding", "crushing", "hardening"]
    assert [p.form for p in held] == forms
    assert all(p.model.joints[-1].support for p in held[1:])


@pytest.mark.parametrize(("tone_frequency", "place"), [(110.0, 0), (45.0, -1)])
def test_the_search_for_a_resonance_begins_where_the_sensor_rings(propose, runs, tone_frequency, place):
    """A slow one comes last: where structures move, there may be a peak anyway."""
    recordings = [toys.recording(run) for run in runs]
    for recording in recordings:
        group = recording["accelerometer"].to_dataset(inherit=False)
        tone = 5.0 * np.sin(2.0 * np.pi * tone_frequency * group["time"]) * np.exp(-3.0 * group["time"])
        group["acceleration"] = group["acceleration"] + tone * (group["sensor"] == "rear_sensor")
        recording["accelerometer"] = xr.DataTree(group)
    ringing = next(p for p in propose("mounting_resonance", None, runs, recordings) if p.location["sensor"] == "rear_sensor")
    found = [start["instrument.accelerometer.rear_sensor.resonance_frequency"] for start in ringing.starts]
    assert found[place] == pytest.approx(tone_frequency, abs=2.0)


def test_an_error_that_is_identified_already_is_not_accused(propose, model):
    known = with_instrument_error(model, "film", "front_marker", "gain", Parameter(1.0))
    assert (("instrument", "film"), ("sensor", "front_marker")) not in places(propose("gain_error", known))
    assert [p.form for p in propose("gain_error", known)].count("constant") == 3


def test_a_bias_may_be_as_large_as_the_largest_reading_of_any_run(propose, runs):
    recordings = [toys.recording(run) for run in runs]
    largest = max(float(np.abs(r["accelerometer"]["acceleration"].sel(sensor="front_sensor")).max()) for r in recordings)
    bias = next(p for p in propose("bias") if p.location.get("sensor") == "front_sensor")
    parameter = bias.model.parameters()["instrument.accelerometer.front_sensor.bias"]
    assert (parameter.lower, parameter.upper) == pytest.approx((-largest, largest))


def test_an_instrument_that_nobody_understands_is_not_accused(propose, runs):
    strange = toys.recording(runs[0])
    strange["film"].attrs["observer"] = "radar"
    assert {p.location["instrument"] for p in propose("gain_error", recordings=[strange])} == {"accelerometer"}


def test_what_is_added_to_a_loading_curve_becomes_part_of_the_joints_law(propose):
    peak = next(p for p in propose("peak_load") if p.location == {"joint": "first"})
    joint = peak.model.joint("first")
    assert joint.law == "crush_plateau + peak"
    assert len(peak.model.joints) == 2
    assert peak.parameters == ("joint.first.peak_force", "joint.first.peak_deformation")


def test_a_joint_that_has_something_added_already_gets_a_neighbour(propose, model):
    first = propose("peak_load")[0].model
    second = next(p for p in propose("bottoming", first) if p.location == {"joint": "first"} and p.form == "line")
    assert second.model.joint("first").law == "crush_plateau + peak"
    beside = second.model.joint("first_bottoming")
    assert (beside.bodies, beside.law) == (("wall", "front"), "linear_stop")


def test_ground_is_no_part_of_the_wall(propose, model):
    """A wall load cell does not feel the friction of the tyres."""
    friction = propose("ground_friction")[0].model
    ground = next(body for body in friction.bodies if body.name not in {b.name for b in model.bodies})
    assert ground.fixed and ground.name in friction.joints[-1].bodies
    assert "wall" not in friction.joints[-1].bodies


def test_a_load_takes_no_load(propose):
    loaded = propose("carried_load")[0].model
    assert places(propose("carried_load", loaded)) == MOVING
    load_body = next(body for body in loaded.bodies if body.carrier)
    assert (load_body.carrier, load_body.position, load_body.velocity) == ("front", (-5.0,), (10.0,))


def test_names_stay_unique_when_the_same_is_found_twice(propose, engine):
    once = propose("viscous_damping")[0].model
    motion = Simulator(once, load().spring_laws, engine).run(np.linspace(0.0, 0.5, 101))
    twice = propose("viscous_damping", once, [motion])[0].model
    names = [joint.name for joint in twice.joints]
    assert len(set(names)) == len(names) == 4


def test_friction_in_a_joint_that_parts_may_end_there_or_not(propose, runs):
    parting = [run.assign(deformation=run["deformation"] - 0.1) for run in runs]
    springing = [run.assign(deformation=np.maximum(run["deformation"], 0.0)) for run in runs]
    crushed = [
        run.assign(deformation=(run["deformation"].dims, np.maximum.accumulate(run["deformation"].values))) for run in runs
    ]
    assert {p.odds for p in propose("joint_friction", motion=parting)} == {0.5}
    assert {p.odds for p in propose("joint_friction", motion=springing)} == {0.5}
    assert {p.odds for p in propose("joint_friction", motion=crushed)} == {1.0}


def test_friction_slides_at_a_rate_that_was_reached(propose, runs):
    """What is established faster than anything moved is a damper."""
    slow = [run.assign(deformation_rate=0.05 * run["deformation_rate"]) for run in runs]
    fastest = max(float(np.abs(run["deformation_rate"].sel(joint="first")).max()) for run in slow)
    (smooth,) = (p for p in propose("joint_friction", motion=slow) if (p.form, p.location) == ("smooth", {"joint": "first"}))
    slip = smooth.model.parameters()["joint.first_joint_friction.slip_rate"]
    assert 0.5 < slip.upper == fastest < 3.0
    assert slip.lower < slip.value < slip.upper


@pytest.mark.parametrize(("physics", "error"), [("gain_error", "gain"), ("bias", "bias")])
def test_where_a_sensor_has_several_axes_one_of_them_alone_may_be_wrong(propose, runs, physics, error):
    """Each is a transducer of its own."""
    recording = toys.recording(runs[0])
    line = recording["accelerometer"].to_dataset(inherit=False)
    plane = xr.concat([line, line.assign_coords(axis=["y"])], dim="axis", data_vars="minimal")
    proposals = propose(physics, recordings=[recording.assign(accelerometer=xr.DataTree(plane))])
    own = {p.form: p.parameters for p in proposals if p.location.get("sensor") == "front_sensor" and "constant" in p.form}
    path = "instrument.accelerometer.front_sensor"
    assert own == {
        "constant": (f"{path}.{error}",),
        "constant, x only": (f"{path}/x.{error}",),
        "constant, y only": (f"{path}/y.{error}",),
    }


def test_sensors_of_one_instrument_on_a_body_that_turns_share_its_frequency(propose, runs):
    """Each has its own height; a marker that is the only one has a frequency of its own."""
    recordings = [_with_both_sensors_on_the_rear(toys.recording(run)) for run in runs]
    rear = next(p for p in propose("rotation", recordings=recordings) if p.location == {"body": "rear"})
    shares = [f"{one}.rocking_share" for one in ("film.rear_marker", "accelerometer.high", "accelerometer.low")]
    shapes = [f"{one}.rocking_{name}" for name in ("frequency", "damping") for one in ("film.rear_marker", "accelerometer.")]
    assert list(rear.parameters) == [f"instrument.{path}" for path in (*shares, *shapes)]


def _with_both_sensors_on_the_rear(recording):
    sensors = recording["accelerometer"].to_dataset(inherit=False).assign_coords(sensor=["high", "low"])
    return recording.assign(accelerometer=xr.DataTree(sensors.assign(sensor_body=("sensor", ["rear", "rear"]))))


@pytest.mark.parametrize("law", sorted(name for name, law in load().spring_laws.items() if law.unit == "N"))
def test_whatever_the_law_of_a_joint_only_parameters_that_its_law_has_are_proposed(propose, law):
    toy = toys.two_degrees()
    specs = load().spring_laws[law].parameters
    own = {s.name: Parameter(1.0 if s.default is None else s.default, fixed=True) for s in specs if not s.vector}
    own |= {s.name: (Parameter(1.0, fixed=True),) * 3 for s in specs if s.vector}
    model = evolve(toy, joints=(toy.joint("first"), evolve(toy.joint("second"), law=law, parameters=own)))
    for proposal in (one for physics in load().hypotheses for one in propose(physics, model)):
        assert set(proposal.parameters) <= proposal.model.free_parameters().keys()
        for joint in proposal.model.joints:
            known = {spec.name for name in (joint.law, *joint.factors) for spec in load().spring_laws[name].parameters}
            assert joint.parameters.keys() <= known, (proposal.physics, proposal.form, joint.law)


@pytest.mark.parametrize("physics", sorted(load().hypotheses))
def test_every_number_has_room_where_a_joint_never_pushed(propose, runs, physics):
    """As one that only a strap holds: no force, no size of a force."""
    slack = [run.assign(force=run["force"].where(run["joint"] != "first", 0.0)) for run in runs]
    numbers = [
        (proposal.form, path, number)
        for proposal in propose(physics, motion=slack)
        for path, number in proposal.model.parameters().items()
        if path in proposal.parameters and not number.fixed
    ]
    assert not [(form, path) for form, path, number in numbers if not number.lower < number.upper]
