"""Physics that was put into a made recording is found again: where it was, and as large as it was."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve
from scipy.constants import g

from crashkit.api import workshop as installed
from crashkit.diagnose.fitting.evidence import best_forms
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.forms import in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry, claims_from_given
from crashkit.diagnose.name.look import LEAST_DROP, Look
from crashkit.diagnose.name.rivals import further_rivals, nearest_rivals
from crashkit.mechanics import Simulator
from crashkit.model import Body, Joint, Parameter
from crashkit.model.edit import with_body, with_factor, with_instrument_error, with_joint
from crashkit.testing import toys

pytestmark = pytest.mark.long

SPEEDS = {"slow": 0.9, "fast": 1.3}
TIMES = np.arange(801) * 2.5e-4
LONGER = np.arange(1601) * 2.5e-4
"""Until everything has sprung back."""
LONGEST = np.arange(2401) * 2.5e-4
"""Until the masses part."""
STD = {"film": ("position", 1e-3), "accelerometer": ("acceleration", 1.0)}
KEPT_ENERGY = 1e6
"""N m-1, slope of unloading."""


def silent(doing, share):
    """Nobody listens."""


def fixed(**values):
    return {name: Parameter(value, fixed=True) for name, value in values.items()}


@pytest.fixture(scope="module")
def model():
    """The two-degree toy, that keeps most of its energy and knows its masses."""
    toy = toys.two_degrees()
    free = toy.parameters()
    slope = Parameter(KEPT_ENERGY, fixed=True)
    known = {f"joint.{joint}.unloading_stiffness": slope for joint in ("first", "second")}
    return toy.with_parameters({"body.rear.mass": evolve(free["body.rear.mass"], fixed=True)} | known)


@pytest.fixture(scope="module")
def workshop(engine):
    return evolve(installed(), engine=engine)


@pytest.fixture(scope="module")
def recorded(model, workshop):
    """What film and accelerometers on both masses record of a true model at two speeds, with noise."""

    def record(true, times):
        seeds = enumerate(SPEEDS.items())
        return {run: one(true, speed, times, np.random.default_rng(seed)) for seed, (run, speed) in seeds}

    def one(true, speed, times, random):
        equipped = workshop.equipped([true])
        carried = tuple(body for body in true.bodies if body.carrier)
        initial = toys.initial_state(evolve(model, bodies=(*model.bodies, *carried)), speed)
        run = Simulator(true, workshop.laws, equipped.engine).run(times, initial=initial)
        recording = toys.recording(run.sel(body=["front", "rear"]))
        return recording.assign(
            {name: xr.DataTree(read(name, recording[name], run, true.instruments, random)) for name in STD}
        )

    def read(name, group, run, errors, random):
        dataset = group.to_dataset(inherit=False)
        quantity, std = STD[name]
        mine = [one for one in errors if one.instrument == name]
        own = {one.sensor: {path: p.value for path, p in one.parameters.items()} for one in mine}
        clean = workshop.observers[name]().predict(run, dataset, own)[quantity]
        return dataset.assign({quantity: clean + random.normal(0.0, std, clean.shape)})

    return record


@pytest.fixture(scope="module")
def found(model, workshop, recorded):
    """The most evident of all proposals of a physics, for recordings of a true model: the proposal, values and deviations."""

    def find(physics, true, of=model, times=TIMES):
        believed = of.with_values({path: 1.03 * p.value for path, p in of.free_parameters().items()})
        given = workshop.first_misfit(believed, recorded(true, times))
        base = begin(workshop.identifier, given).advance(30).fitted()
        motion = [base.predictor.motion(run, base.values(base.start())) for run in base.recordings]
        proposals = workshop.hypotheses[physics]().propose(base.model, motion, list(base.recordings.values()))
        equipped = workshop.equipped([proposal.model for proposal in proposals])
        nearest, _ = nearest_rivals(equipped, base, proposals, lambda _: LEAST_DROP, silent)
        inquiry = Inquiry(equipped, given, begin(workshop.identifier, base), silent)
        from_given = claims_from_given(inquiry, base, proposals)
        ranked = further_rivals(equipped, base, from_given, proposals, nearest, True, silent).rivals
        look = Look(tuple(best_forms(ranked)), (1.0,), 0.0, base)
        (look,), search = in_best_forms(inquiry, [look], look.leader.search, thorough=True)
        proposal, search = look.leader.proposal, search.advance(40)
        table = search.result().parameters.sel(parameter=list(proposal.parameters))
        values = {path.rsplit(".", 1)[-1]: float(v) for path, v in zip(proposal.parameters, table["value"], strict=True)}
        stds = {path.rsplit(".", 1)[-1]: float(v) for path, v in zip(proposal.parameters, table["std"], strict=True)}
        return proposal, values, stds, search.normalised

    return find


def with_law(model, more, **numbers):
    """More in the law of the first joint."""
    first = model.joint("first")
    changed = evolve(first, law=f"{first.law} {more}", parameters={**first.parameters, **fixed(**numbers)})
    return evolve(model, joints=tuple(changed if joint.name == "first" else joint for joint in model.joints))


def broken(model):
    return with_factor(model, "second", "fracture", fixed(fracture_deformation=0.12, loss=0.6))


def softened(model):
    parameters = fixed(softening_deformation=0.2, softening_length=0.25, loss=0.5)
    return with_factor(model, "first", "softening", parameters)


def weakened_curve(model):
    """What the loading curve of the first joint loses; it unloads as steeply as before."""
    return with_law(model, "+ lost_force", lost_force=1e4, softening_deformation=0.3, softening_length=0.1)


def relaxing(model):
    element = fixed(relaxing_stiffness=1e5, relaxation_time=0.02, clearance=0.0, tension=0.0)
    return with_joint(model, Joint("memory", ("front", "rear"), "maxwell", element))


def relaxing_twice(model):
    """A Prony series of two terms."""
    for name, time in (("short", 3e-3), ("long", 0.08)):
        element = fixed(relaxing_stiffness=4e5, relaxation_time=time, clearance=0.0, tension=0.0)
        model = with_joint(model, Joint(name, ("front", "rear"), "maxwell", element))
    return model


def quasi_linear(model):
    return with_law(model, "~ quasi_linear", fresh_share=0.4, relaxation_time=0.03, holds=0.0)


def staying_crushed(model):
    """The first joint comes back to 70 % of its largest deformation, along a curve."""
    level = model.with_parameters({"joint.first.unloading_stiffness": Parameter(1.0, fixed=True)})
    return with_factor(level, "first", "residual_set", fixed(loss=1.0, residual_share=0.7, unloading_exponent=2.5))


def partly_crushed(model):
    """Of the first joint three tenths stay crushed."""
    return with_law(model, "% plastic_share", plastic_share=0.3, unloading_stiffness=1e6)


def fading(model):
    return with_factor(model, "first", "fading", fixed(fading_share=0.4, relaxation_time=0.03))


def engaging_softly(model):
    return model.with_parameters(fixed(**{"joint.first.clearance": 0.02, "joint.first.toe": 0.12}))


def padded(model):
    """A pad in the gap of the first joint."""
    return with_law(model, "| pad", clearance=0.08, pad_force=2e4, pad_exponent=2.0)


def rubbing_in_its_gap(model):
    """Something rubs in the gap of the first joint."""
    return with_law(model, "| rubbing_gap", clearance=0.08, friction_force=4e3, slip_rate=0.05)


def limited(model):
    """A rate effect that has its limit soon after its reference rate."""
    parameters = fixed(rate_amplitude=0.4, reference_rate=2.0, limit_sharpness=4.0)
    return with_factor(model, "first", "rate_saturating", parameters)


def buckling(model):
    return with_law(model, "+ peak", peak_force=2e4, peak_deformation=0.1, peak_sharpness=20.0)


def buckling_suddenly(model):
    return with_law(model, "+ pointed_peak", peak_force=6e4, peak_deformation=0.15, peak_width=0.12)


def buckling_slowly(model):
    """It rises for longer than it falls."""
    return with_law(model, "+ pointed_peak", peak_force=6e4, peak_deformation=0.25, peak_width=0.08, peak_rise=0.2)


def buckling_for_long(model):
    """Its peak is lost little by little."""
    return with_law(model, "+ decaying_peak", peak_force=4e4, peak_deformation=0.25, peak_width=0.15, peak_rise=0.05)


def buckling_deeply(model):
    """Behind its peak it carries less than its plateau for a while."""
    return with_law(model, "+ dipping_peak", peak_force=4e4, peak_deformation=0.15, peak_width=0.08, dip=0.5, recovery=0.25)


def stopped(model):
    """By rubber beside the first joint, which gives back what it took."""
    stop = fixed(stiffness=1.5e5, stop_deformation=0.5)
    return with_joint(model, Joint("stop", ("wall", "front"), "linear_stop", stop))


def pressed_by_rubber(model):
    """A ball that takes up a part of what it is given."""
    rubber = fixed(force=2e4, stop_deformation=0.4, exponent=1.5, way=0.1, loss=0.3)
    return with_joint(model, Joint("stop", ("wall", "front"), "hunt_crossley", rubber))


def buffered(model):
    """A stop with a dashpot beside the first joint."""
    stop = fixed(stiffness=6e4, stop_deformation=0.4, damping=4e3)
    return with_joint(model, Joint("stop", ("wall", "front"), "damped_stop", stop))


def pressed_by_a_ball(model):
    """After Hertz."""
    stop = fixed(force=4e4, stop_deformation=0.4, exponent=1.5, loss=0.0, way=0.2)
    return with_joint(model, Joint("stop", ("wall", "front"), "hunt_crossley", stop))


def rubbing(model):
    return with_joint(model, Joint("rub", ("wall", "front"), "coulomb", fixed(friction_force=4e3, slip_rate=0.05)))


def wedging(model):
    """Wedges grip on the way in and slip back with half of that."""
    wedges = fixed(friction_force=6e3, slip_rate=0.1, rebound=0.5)
    return with_joint(model, Joint("rub", ("wall", "front"), "coulomb", wedges))


def clamping(model):
    """The more it is pressed, the more it rubs."""
    return with_factor(model, "first", "rubbing", fixed(friction_share=0.2, slip_rate=0.05))


def clamped(model):
    """It rubs even where nothing else presses it."""
    return with_joint(clamping(model), Joint("rub", ("wall", "front"), "coulomb", fixed(friction_force=3e3, slip_rate=0.1)))


def clamped_and_gripping(model):
    """The same, half as much again at creep speed; and slow in being established."""
    clamp = fixed(friction_share=0.15, slip_rate=0.2, stick=0.5, stick_rate=1.5)
    rub = fixed(friction_force=5e3, slip_rate=0.2, stick=0.5, stick_rate=1.5)
    return with_joint(with_factor(model, "first", "rubbing", clamp), Joint("rub", ("wall", "front"), "coulomb", rub))


def bristling(model):
    bristles = fixed(friction_force=5e3, bristle_length=0.04)
    return with_joint(model, Joint("rub", ("wall", "front"), "dahl", bristles))


def finely_rubbing(model):
    """Friction of short bristles."""
    bristles = fixed(friction_force=5e3, bristle_length=0.003)
    return with_joint(model, Joint("rub", ("wall", "front"), "dahl", bristles))


def folding(model, **shape):
    """Some five folds from the elastic limit on."""
    return with_law(model, "+ folding", amplitude=8e3, fold_length=0.3, onset=0.2, **shape)


def skewed(model):
    """Five folds that rise fast, fall slowly, and get shorter and lower."""
    return folding(model, skew=0.7, shortening=0.02, weakening=0.1)


def zigzagging(model):
    """Folds like a triangle, as a table of straight lines would have them."""
    return folding(model, pointedness=0.98)


def cargo(model):
    """A load that slides in the rear until it hits what stops it."""
    loaded = with_body(model, evolve(model.body("rear"), name="cargo", mass=Parameter(60.0, fixed=True), carrier="rear"))
    stop = fixed(stiffness=4e4, damping=600.0, slack=0.03, holds=1.0)
    stopped = with_joint(loaded, Joint("stop", ("cargo", "rear"), "tie", stop))
    return with_joint(stopped, Joint("floor", ("cargo", "rear"), "coulomb", fixed(friction_force=300.0, slip_rate=0.05)))


def belted(model):
    """A load in a belt that gets stiffer, and that is let go."""
    loaded = with_body(model, evolve(model.body("rear"), name="load", mass=Parameter(300.0, fixed=True), carrier="rear"))
    belt = fixed(stiffness=8e3, damping=300.0, slack=0.05, stiffening=40.0)
    return with_joint(loaded, Joint("belt", ("load", "rear"), "tie", belt))


def strapped(model):
    """The same in a strap that gives back little of what it took."""
    loaded = belted(model)
    strap, less = loaded.joint("belt"), fixed(loss=0.6, unloading_length=0.01)
    strap = evolve(strap, factors=("unloading_loss",), parameters={**strap.parameters, **less})
    return evolve(loaded, joints=tuple(strap if joint.name == "belt" else joint for joint in loaded.joints))


def hooked(model):
    """A hook latches as the second joint is crushed."""
    hook = fixed(pull_force=4e3, play=0.03, pull_exponent=2.0, way=0.02)
    return with_joint(model, Joint("hook", model.joint("second").bodies, "hook", hook))


def coupled(model):
    """The same, but the hook yields."""
    hook = fixed(pull_force=1e4, play=0.03, way=0.02, pull_limit=1.5e4)
    return with_joint(model, Joint("hook", model.joint("second").bodies, "hook", hook))


def digressive(model):
    """A shock absorber that gives half of its limit at 3 m/s."""
    return with_joint(
        model, Joint("absorber", ("wall", "front"), "viscous_saturating", fixed(damping=8e3, saturating_rate=3.0))
    )


def coming_in(model):
    """The same that takes hold over 60 mm."""
    absorber = fixed(damping=8e3, saturating_rate=3.0, engagement=0.06)
    return with_joint(model, Joint("absorber", ("wall", "front"), "viscous_saturating", absorber))


def valved(model):
    """A shock absorber whose valve opens at 0.5 m/s."""
    valve = fixed(damping=8e3, knee_rate=0.5, beyond=0.2)
    return with_joint(model, Joint("absorber", ("wall", "front"), "viscous_knee", valve))


def throttled(model):
    """A damper whose orifices close with the stroke."""
    orifices = fixed(damping=2e3, doubling_deformation=0.2)
    return with_joint(model, Joint("absorber", ("wall", "front"), "viscous_growing", orifices))


def checked(model):
    """A damper that holds back nothing on the way back."""
    return with_joint(
        model, Joint("absorber", ("front", "rear"), "viscous_power", fixed(damping=6e3, exponent=1.0, rebound=0.0))
    )


def pleated(model):
    """Folds like the teeth of a saw, that rise with the force."""
    return with_factor(model, "second", "folding_share", fixed(fold_share=0.1, fold_length=0.07, onset=0.09, skew=0.8))


def stiffening(model):
    """An exponential wall in the loading curve of the first joint."""
    first, wall = model.joint("first"), fixed(force=2e3, stop_deformation=0.6, growth_way=0.25)
    walled = evolve(first, law="crush_plateau + exponential_stop", parameters={**first.parameters, **wall})
    return evolve(model, joints=(walled, *model.joints[1:]))


def curving(model):
    """A cubic in the loading curve of the first joint."""
    first, wall = model.joint("first"), fixed(force=3e4, stop_deformation=0.4, exponent=3.0, way=0.3)
    walled = evolve(first, law="crush_plateau + power_stop", parameters={**first.parameters, **wall})
    return evolve(model, joints=(walled, *model.joints[1:]))


def belted_in(model):
    """A belt holds the masses together as they part, and yields."""
    belt = fixed(stiffness=1e5, slack=0.0, yield_force=5e3, corner=2.0)
    return with_joint(model, Joint("belt", model.joint("second").bodies, "yielding_strap", belt))


def ripping(model):
    smooth = fixed(softening_middle=0.8, softening_spread=0.1, loss=0.5)
    return with_factor(model, "first", "smooth_softening", smooth)


def unzipped(model):
    steps = fixed(softening_deformation=0.5, softening_length=0.1, loss=0.3, step_way=0.7, second_loss=0.3)
    return with_factor(model, "first", "stepwise_softening", steps)


def cracking(model):
    """A crack begins to run some time after its member has been deformed so far."""
    late = fixed(softening_deformation=0.3, loss=0.5, delay=0.03, duration=0.01)
    return with_factor(model, "first", "delayed_softening", late)


def pulsed(model):
    """A force of the time alone, in the first joint."""
    heights = tuple(Parameter(height, fixed=True) for height in (0.0, 6e3, 9e3, 0.0, -4e3, 0.0))
    table = Joint("pulse", ("wall", "front"), "time_table", {"heights": heights, **fixed(duration=0.2)})
    return with_joint(model, table)


def weakened(model):
    """The factor of a rate that no rate law has: weaker in the middle of its range."""
    heights = tuple(Parameter(height, fixed=True) for height in (0.0, 0.0, 0.0, -0.2, 0.0))
    return with_factor(model, "first", "rate_curve", {"rate_heights": heights, **fixed(rate_reach=14.0)})


def touching(model):
    return with_joint(model, Joint("touch", ("wall", "rear"), "quadratic_stop", fixed(coefficient=6e4, stop_deformation=0.9)))


def struck(model):
    contact = fixed(force=2e4, stop_deformation=0.9, exponent=1.5, loss=0.2, way=0.1)
    return with_joint(model, Joint("touch", ("wall", "rear"), "hunt_crossley", contact))


def struck_with_a_dashpot(model):
    contact = fixed(stiffness=8e4, stop_deformation=0.9, damping=4e3)
    return with_joint(model, Joint("touch", ("wall", "rear"), "damped_stop", contact))


def met_by_a_member(model):
    """Whose force rises from where it yields to where it densifies."""
    numbers = fixed(final_stiffness=3e5, unloading_stiffness=6e5, clearance=0.75)
    corners = {"deformation": (0.08, 0.25), "force": (4e4, 6e4)}
    numbers |= {name: tuple(Parameter(value, fixed=True) for value in values) for name, values in corners.items()}
    return with_joint(model, Joint("touch", ("wall", "rear"), "piecewise_affine", numbers))


def rubbing_contact(model):
    """Of what the contact takes, less comes back."""
    contact = fixed(force=2e4, stop_deformation=0.9, exponent=1.5, way=0.1, friction_share=0.4, slip_rate=0.1)
    return with_joint(model, Joint("touch", ("wall", "rear"), "power_stop", contact, factors=("rubbing",)))


def absorbing(model):
    """A shock absorber that is weaker on the way back."""
    valves = fixed(damping=4e3, exponent=1.0, rebound=0.35)
    return with_joint(model, Joint("absorber", ("front", "rear"), "viscous_power", valves))


def pulling(model):
    """The second joint pulls, less steeply than it pushes, until it slips."""
    second = model.joint("second")
    hooked = evolve(second, parameters={**second.parameters, **fixed(tension=0.6, tension_force=1.5e4)})
    return evolve(model, joints=(model.joint("first"), hooked))


def pulling_weakly(model):
    """It pulls a tenth as steeply as it pushes, until it slips."""
    second = model.joint("second")
    loose = evolve(second, parameters={**second.parameters, **fixed(tension=0.1, tension_force=4e3)})
    return evolve(model, joints=(model.joint("first"), loose))


def released(model, mass):
    wall = evolve(model.body("wall"), fixed=False, mass=Parameter(mass, fixed=True))
    return evolve(model, bodies=(wall, *model.bodies[1:]))


def grounded(model, law, parameters):
    ground = Body("ground", (100.0,), (0.0,), fixed=True)
    held = Joint("held", ("ground", "wall"), law, parameters, support=True)
    return with_joint(evolve(model, bodies=(*model.bodies, ground)), held)


def attracting(model):
    """Wall and rear pull each other as they come near, and let go when they are nearer."""
    heights = tuple(Parameter(height, fixed=True) for height in (0.0, -2e3, -5e3, -5e3, 0.0))
    pull = {"heights": heights, **fixed(reach=1.2)}
    return with_joint(model, Joint("magnet", ("wall", "rear"), "smooth_table", pull))


def repelling(model):
    """Two magnets at the ends of the second joint, before they touch and after they part."""
    rear, front = (model.body(name).position[0] for name in ("rear", "front"))
    push = {"heights": tuple(Parameter(3e3 * 1.4**n, fixed=True) for n in range(6)), **fixed(reach=2.0)}
    length = Parameter(abs(rear - front) + 1.0, fixed=True)
    return with_joint(model, Joint("magnets", ("front", "rear"), "smooth_table", push, free_length=length))


def pushed_away(model):
    return released(model, 4e3)


def sliding(model):
    return grounded(released(model, 2500.0), "coulomb", fixed(friction_force=2.5e4, slip_rate=0.1))


def sprung(model):
    return grounded(released(model, 500.0), "tie", fixed(stiffness=4e5, damping=2e3, slack=0.0, holds=1.0))


def in_soil(model):
    """A post that yields at 30 kN, and goes on to be held more."""
    soil = fixed(elastic_stiffness=6e5, crush_force=3e4, densification_deformation=1e-4, densification_stiffness=8e4)
    return grounded(released(model, 500.0), "crush_plateau | viscous", {**soil, **fixed(unloading_stiffness=2e6, damping=2e3)})


def braked(model):
    """A brake that is put on after a while."""
    ground = Body("ground", (100.0,), (0.0,), fixed=True)
    brake = fixed(friction_force=8e3, slip_rate=0.05, start=0.03, rise=0.02)
    return with_joint(evolve(model, bodies=(*model.bodies, ground)), Joint("brake", ("ground", "rear"), "brake", brake))


def dragging(model):
    """Something under the rear touches the ground after 0.8 m."""
    ground = Body("ground", (100.0,), (0.0,), fixed=True)
    drag = fixed(friction_force=4e3, slip_rate=0.05, always=0.0, clearance=0.8)
    return with_joint(evolve(model, bodies=(*model.bodies, ground)), Joint("drag", ("ground", "rear"), "coulomb", drag))


def clipping(model):
    return with_error(model, "rear_sensor", saturation=45.0)


def ringing(model):
    return with_error(model, "front_sensor", resonance_share=1.0, resonance_frequency=120.0, resonance_damping=0.03)


def ringing_inside(model):
    """Its sensing element rings, and not its mount."""
    element = {"resonance_share": 1.0, "resonance_path": 0.0, "resonance_frequency": 70.0, "resonance_damping": 0.2}
    return with_error(model, "front_sensor", **element)


def rocking(model):
    """The rear pitches; the marker and the sensor are not equally high."""
    for instrument, sensor, share in (("accelerometer", "rear_sensor", 0.4), ("film", "rear_marker", -0.25)):
        errors = {"rocking_share": share, "rocking_frequency": 9.0, "rocking_damping": 0.2}
        model = with_error(model, sensor, instrument, **errors)
    return model


def pitching(model):
    """The same as slowly as a car on its suspension: a quarter of a turn."""
    for instrument, sensor, share in (("accelerometer", "rear_sensor", 0.2), ("film", "rear_marker", -0.15)):
        errors = {"rocking_share": share, "rocking_frequency": 1.4, "rocking_damping": 0.12}
        model = with_error(model, sensor, instrument, **errors)
    return model


def drifting(model):
    return with_error(model, "rear_sensor", bias=2.0, bias_drift=30.0)


def leaning(model):
    return with_error(model, "rear_sensor", lean=-0.35)


def heaving(model):
    """The rear also moves up and down, which only the sensor that leans sees."""
    errors = {"rocking_share": 0.3, "rocking_frequency": 6.0, "rocking_damping": 0.15}
    return with_error(model, "rear_sensor", lean=0.3, **errors)


def shifting(model):
    return with_error(model, "rear_sensor", zero_shift=9.0, zero_shift_time=0.06, zero_shift_rise=5e-4)


def understating(model):
    """The more it feels, the less of it it reads, and too little of everything."""
    return with_error(model, "rear_sensor", gain=0.85, cubic=-1e-5)


def lopsided(model):
    """It reads more of what stops it than of what starts it."""
    return with_error(model, "rear_sensor", gain=1.1, quadratic=-1.5e-3)


def exaggerating(model):
    """The more it feels, the more of it it reads."""
    return with_error(model, "rear_sensor", gain=0.9, cubic=8e-6)


def gaining(model):
    """The film's clock is late, and gets later."""
    return with_error(model, "", "film", clock_offset=1e-3, clock_rate=0.02)


def bending(model):
    return with_error(model, "rear_sensor", saturation_soft=120.0)


def giving_way(model):
    """Its amplifier clips with a knee."""
    return with_error(model, "rear_sensor", saturation_knee=45.0, knee_sharpness=5.0)


def with_error(model, sensor, instrument="accelerometer", **errors):
    for name, value in errors.items():
        model = with_instrument_error(model, instrument, sensor, name, Parameter(value, fixed=True))
    return model


def pushing(model, law, **values):
    """Another law beside that of the second joint, which only pushes with it."""
    second = model.joint("second")
    both = evolve(second, law=f"{second.law} & {law}", parameters={**second.parameters, **fixed(**values)})
    return evolve(model, joints=tuple(both if joint.name == "second" else joint for joint in model.joints))


def cushioned(model):
    return pushing(model, "viscous", damping=6e3)


def choked(model):
    """The orifices close with the stroke."""
    return pushing(model, "viscous_growing", damping=3e3, doubling_deformation=0.1)


def bristling_and_pushing(model):
    return pushing(model, "dahl", friction_force=6e3, bristle_length=0.03, always=0.0)


def cushioned_and_relaxing(model):
    return pushing(model, "maxwell", relaxing_stiffness=1.5e5, relaxation_time=0.05, holds=1.0)


CASES = {
    softened: (
        ("fracture", "compression", {"joint": "first"}),
        {"loss": 0.5, "softening_deformation": 0.2, "softening_length": 0.25},
    ),
    weakened_curve: (
        ("fracture", "of its loading curve", {"joint": "first"}),
        {"lost_force": 1e4, "softening_deformation": 0.3, "softening_length": 0.1},
    ),
    relaxing: (("relaxation", "maxwell", {"joint": "second"}), {"relaxing_stiffness": 1e5, "relaxation_time": 0.02}),
    relaxing_twice: (
        ("relaxation", "two branches", {"joint": "second"}),
        {"relaxing_stiffness": 4e5, "relaxation_time": 0.08},
    ),
    quasi_linear: (
        ("relaxation", "quasi-linear", {"joint": "first"}),
        {"fresh_share": 0.4, "relaxation_time": 0.03},
    ),
    fading: (("relaxation", "fading", {"joint": "first"}), {"fading_share": 0.4, "relaxation_time": 0.03}),
    engaging_softly: (("clearance", "toe", {"joint": "first"}), {"clearance": 0.02, "toe": 0.12}),
    padded: (("clearance", "padded", {"joint": "first"}), {"clearance": 0.08, "pad_force": 2e4, "pad_exponent": 2.0}),
    rubbing_in_its_gap: (
        ("clearance", "rubbing", {"joint": "first"}),
        {"clearance": 0.08, "friction_force": 4e3},
    ),
    limited: (
        ("rate_dependence", "to a limit, sharply", {"joint": "first"}),
        {"rate_amplitude": 0.4, "reference_rate": 2.0, "limit_sharpness": 4.0},
    ),
    buckling: (
        ("peak_load", "narrow", {"joint": "first"}),
        {"peak_force": 2e4, "peak_deformation": 0.1, "peak_sharpness": 20.0},
    ),
    buckling_suddenly: (
        ("peak_load", "pointed", {"joint": "first"}),
        {"peak_deformation": 0.15},
    ),
    buckling_slowly: (
        ("peak_load", "uneven", {"joint": "first"}),
        {"peak_deformation": 0.25, "peak_width": 0.08, "peak_rise": 0.2},
    ),
    buckling_for_long: (
        ("peak_load", "decaying", {"joint": "first"}),
        {"peak_deformation": 0.25, "peak_width": 0.15, "peak_rise": 0.05},
    ),
    buckling_deeply: (
        ("peak_load", "with a dip", {"joint": "first"}),
        {"peak_deformation": 0.15, "peak_width": 0.08, "dip": 0.5, "recovery": 0.25},
    ),
    stopped: (("bottoming", "line, both ways", {"joint": "first"}), {"stiffness": 1.5e5, "stop_deformation": 0.5}),
    pressed_by_rubber: (("bottoming", "damped", {"joint": "first"}), {"exponent": 1.5, "stop_deformation": 0.4, "loss": 0.3}),
    buffered: (
        ("bottoming", "with a dashpot", {"joint": "first"}),
        {"stiffness": 6e4, "stop_deformation": 0.4, "damping": 4e3},
    ),
    pressed_by_a_ball: (("bottoming", "power, both ways", {"joint": "first"}), {"exponent": 1.5, "stop_deformation": 0.4}),
    rubbing: (("joint_friction", "sharp", {"joint": "first"}), {"friction_force": 4e3}),
    wedging: (("joint_friction", "two-way", {"joint": "first"}), {"friction_force": 6e3, "rebound": 0.5}),
    clamping: (("joint_friction", "in proportion", {"joint": "first"}), {"friction_share": 0.2}),
    clamped_and_gripping: (
        ("joint_friction", "in proportion, falling, preloaded", {"joint": "first"}),
        {"friction_share": 0.15},
    ),
    clamped: (
        ("joint_friction", "in proportion, preloaded", {"joint": "first"}),
        {"friction_share": 0.2, "friction_force": 3e3},
    ),
    bristling: (
        ("joint_friction", "bristles", {"joint": "first"}),
        {"friction_force": 5e3, "bristle_length": 0.04},
    ),
    finely_rubbing: (
        ("joint_friction", "bristles", {"joint": "first"}),
        {"friction_force": 5e3, "bristle_length": 0.003},
    ),
    folding: (
        ("progressive_folding", "sine", {"joint": "first"}),
        {"amplitude": 8e3, "fold_length": 0.3, "onset": 0.2},
    ),
    skewed: (
        ("progressive_folding", "shaped", {"joint": "first"}),
        {"amplitude": 8e3, "fold_length": 0.3, "skew": 0.7, "shortening": 0.02, "weakening": 0.1},
    ),
    zigzagging: (
        ("progressive_folding", "pointed", {"joint": "first"}),
        {"amplitude": 8e3, "fold_length": 0.3, "pointedness": 0.98},
    ),
    cargo: (("carried_load", "sliding", {"body": "rear"}), {"mass": 60.0, "slack": 0.03, "friction_force": 300.0}),
    belted: (("carried_load", "stiffening", {"body": "rear"}), {"mass": 300.0, "slack": 0.05, "stiffening": 40.0}),
    strapped: (("carried_load", "strap", {"body": "rear"}), {"mass": 300.0, "slack": 0.05, "loss": 0.6}),
    hooked: (("tension", "hook", {"joint": "second"}), {"play": 0.03, "pull_exponent": 2.0}),
    coupled: (("tension", "hook, yielding", {"joint": "second"}), {"play": 0.03, "pull_limit": 1.5e4}),
    pleated: (
        ("progressive_folding", "in proportion", {"joint": "second"}),
        {"fold_share": 0.1, "fold_length": 0.07, "onset": 0.09, "skew": 0.8},
    ),
    throttled: (
        ("viscous_damping", "growing with the stroke", {"joint": "first"}),
        {"damping": 2e3, "doubling_deformation": 0.2},
    ),
    checked: (("viscous_damping", "linear, one way", {"joint": "second"}), {"damping": 6e3}),
    valved: (("viscous_damping", "with a knee", {"joint": "first"}), {"damping": 8e3, "knee_rate": 0.5, "beyond": 0.2}),
    digressive: (("viscous_damping", "saturating", {"joint": "first"}), {"damping": 8e3, "saturating_rate": 3.0}),
    coming_in: (
        ("viscous_damping", "saturating, coming in", {"joint": "first"}),
        {"damping": 8e3, "saturating_rate": 3.0, "engagement": 0.06},
    ),
    stiffening: (("bottoming", "exponential", {"joint": "first"}), {}),
    curving: (("bottoming", "power", {"joint": "first"}), {"stop_deformation": 0.4, "exponent": 3.0}),
    belted_in: (("tension", "strap, yielding", {"joint": "second"}), {"yield_force": 5e3, "corner": 2.0}),
    ripping: (
        ("fracture", "smoothly", {"joint": "first"}),
        {"loss": 0.5, "softening_middle": 0.8, "softening_spread": 0.1},
    ),
    unzipped: (
        ("fracture", "in two steps", {"joint": "first"}),
        {"loss": 0.3, "second_loss": 0.3, "softening_deformation": 0.5, "step_way": 0.7},
    ),
    cracking: (
        ("fracture", "delayed", {"joint": "first"}),
        {"loss": 0.5, "softening_deformation": 0.3, "delay": 0.03, "duration": 0.01},
    ),
    pulsed: (("unknown", "time", {"joint": "first"}), {}),
    weakened: (("unknown", "rate, as a factor", {"joint": "first"}), {}),
    attracting: (("unknown", "deformation", {"bodies": ["wall", "rear"]}), {}),
    repelling: (("unknown", "deformation, at a distance", {"joint": "second"}), {}),
    touching: (
        ("missing_contact", "parabola", {"bodies": ["wall", "rear"]}),
        {"coefficient": 6e4, "stop_deformation": 0.9},
    ),
    rubbing_contact: (
        ("missing_contact", "power, rubbing", {"bodies": ["wall", "rear"]}),
        {"exponent": 1.5, "stop_deformation": 0.9, "friction_share": 0.4},
    ),
    struck: (
        ("missing_contact", "damped", {"bodies": ["wall", "rear"]}),
        {"loss": 0.2, "exponent": 1.5, "stop_deformation": 0.9},
    ),
    struck_with_a_dashpot: (
        ("missing_contact", "with a dashpot", {"bodies": ["wall", "rear"]}),
        {"stiffness": 8e4, "stop_deformation": 0.9, "damping": 4e3},
    ),
    met_by_a_member: (
        ("missing_contact", "member, rising", {"bodies": ["wall", "rear"]}),
        {"clearance": 0.75, "force[0]": 4e4, "force[1]": 6e4, "deformation[0]": 0.08, "deformation[1]": 0.25},
    ),
    absorbing: (("viscous_damping", "two-way", {"joint": "second"}), {"damping": 4e3, "rebound": 0.35}),
    cushioned: (("viscous_damping", "linear, only pushing", {"joint": "second"}), {"damping": 6e3}),
    bristling_and_pushing: (
        ("joint_friction", "bristles, only pushing", {"joint": "second"}),
        {"friction_force": 6e3, "bristle_length": 0.03},
    ),
    cushioned_and_relaxing: (
        ("relaxation", "maxwell, only pushing", {"joint": "second"}),
        {"relaxing_stiffness": 1.5e5, "relaxation_time": 0.05},
    ),
    choked: (
        ("viscous_damping", "growing with the stroke, only pushing", {"joint": "second"}),
        {"damping": 3e3, "doubling_deformation": 0.1},
    ),
    pulling: (("tension", "own line, to a limit", {"joint": "second"}), {"tension_force": 1.5e4, "tension": 0.6}),
    pulling_weakly: (("tension", "own line, to a limit", {"joint": "second"}), {"tension_force": 4e3, "tension": 0.1}),
    sliding: (("obstacle_motion", "sliding", {"body": "wall"}), {"mass": 2500.0, "friction_force": 2.5e4}),
    pushed_away: (("obstacle_motion", "free", {"body": "wall"}), {"mass": 4e3}),
    in_soil: (
        ("obstacle_motion", "hardening", {"body": "wall"}),
        {"crush_force": 3e4, "densification_stiffness": 8e4},
    ),
    sprung: (("obstacle_motion", "sprung", {"body": "wall"}), {"mass": 500.0, "stiffness": 4e5, "damping": 2e3}),
    braked: (
        ("ground_friction", "from a time on", {"body": "rear"}),
        {"friction_force": 8e3, "start": 0.03, "rise": 0.02},
    ),
    dragging: (("ground_friction", "later", {"body": "rear"}), {"friction_force": 4e3, "clearance": 0.8}),
    clipping: (("saturation", "limit", {"sensor": "rear_sensor"}), {"saturation": 45.0}),
    ringing: (
        ("mounting_resonance", "oscillator", {"sensor": "front_sensor"}),
        {"resonance_frequency": 120.0, "resonance_damping": 0.03},
    ),
    ringing_inside: (
        ("mounting_resonance", "element", {"sensor": "front_sensor"}),
        {"resonance_share": 1.0, "resonance_frequency": 70.0, "resonance_damping": 0.2},
    ),
    rocking: (("rotation", "rocking", {"body": "rear"}), {"rocking_frequency": 9.0, "rocking_damping": 0.2}),
    pitching: (("rotation", "rocking", {"body": "rear"}), {}),
    heaving: (("misalignment", "lean, heaving", {"sensor": "rear_sensor"}), {"lean": 0.3, "rocking_frequency": 6.0}),
    shifting: (("bias", "shift", {"sensor": "rear_sensor"}), {"zero_shift": 9.0, "zero_shift_time": 0.06}),
    bending: (("saturation", "soft", {"sensor": "rear_sensor"}), {"saturation_soft": 120.0}),
    giving_way: (
        ("saturation", "knee", {"sensor": "rear_sensor"}),
        {"saturation_knee": 45.0, "knee_sharpness": 5.0},
    ),
    understating: (("gain_error", "falling", {"sensor": "rear_sensor"}), {"gain": 0.85, "cubic": -1e-5}),
    lopsided: (("gain_error", "uneven", {"sensor": "rear_sensor"}), {"gain": 1.1, "quadratic": -1.5e-3}),
    exaggerating: (("gain_error", "rising", {"sensor": "rear_sensor"}), {"gain": 0.9, "cubic": 8e-6}),
    gaining: (("clock_offset", "drift", {"instrument": "film"}), {"clock_offset": 1e-3, "clock_rate": 0.02}),
    drifting: (("bias", "drift", {"sensor": "rear_sensor"}), {"bias": 2.0, "bias_drift": 30.0}),
}

LATE = {
    checked,
    pulling_weakly,
    absorbing,
    cushioned,
    choked,
    bristling_and_pushing,
    cushioned_and_relaxing,
    buffered,
    belted,
    strapped,
    hooked,
    coupled,
    pulling,
    relaxing_twice,
    stopped,
    pressed_by_a_ball,
    pressed_by_rubber,
    wedging,
    clamping,
    clamped,
    clamped_and_gripping,
    rubbing_in_its_gap,
    weakened_curve,
    repelling,
}
"""What acts on the way back."""


@pytest.mark.parametrize("conceal", CASES, ids=lambda conceal: conceal.__name__)
def test_what_was_concealed_is_found_where_it_was(found, model, conceal):
    (physics, form, place), true = CASES[conceal]
    proposal, values, stds, normalised = found(
        physics, conceal(model), times=LONGEST if conceal is belted_in else LONGER if conceal in LATE else TIMES
    )
    # What never lets go holds as well as not, and what never pulls only pushes.
    assert proposal.form in (form, f"{form}, holding", f"{form}, only pushing")
    assert {key: proposal.location[key] for key in place} == place
    assert normalised == pytest.approx(1.0, abs=0.05 if physics == "unknown" else 0.03)  # an estimate is a coarse table
    for name, value in true.items():
        assert abs(values[name] - value) < 4.0 * stds[name] + 0.01 * abs(value), (name, values[name], stds[name])


def test_how_far_a_sensor_leans_is_found_but_not_to_which_side(found, model):
    """cos(lean) is the same on both, and gravity's share is told apart from an offset by nothing."""
    proposal, values, stds, normalised = found("misalignment", leaning(model))
    assert (proposal.form, proposal.location["sensor"]) == ("lean", "rear_sensor")
    assert abs(values["lean"]) == pytest.approx(0.35, abs=4.0 * stds["lean"])
    assert g * np.sin(values["lean"]) + values["bias"] == pytest.approx(-g * np.sin(0.35), abs=0.2)
    assert normalised == pytest.approx(1.0, abs=0.03)


def crushed_twice(model):
    """The first joint unloads along two lines."""
    return with_law(model, "/ second_line", unloading_stiffness=3e6, turning_share=0.5, slope_ratio=0.2)


CRUSHED = {
    staying_crushed: ("set", {"residual_share": 0.7, "unloading_exponent": 2.5}),
    partly_crushed: ("line of a share", {"plastic_share": 0.3, "unloading_stiffness": 1e6}),
    crushed_twice: ("two lines", {"unloading_stiffness": 3e6, "turning_share": 0.5, "slope_ratio": 0.2}),
}


@pytest.mark.parametrize("conceal", CRUSHED, ids=lambda conceal: conceal.__name__)
def test_a_member_that_stays_crushed_is_told_from_one_that_springs_back(found, model, conceal):
    form, true = CRUSHED[conceal]
    elastic = model.with_parameters({"joint.first.unloading_stiffness": Parameter(0.0, fixed=True)})
    proposal, values, stds, normalised = found("plastic_unloading", conceal(elastic), elastic, LONGER)
    assert (proposal.form, proposal.location) == (form, {"joint": "first"})
    assert normalised == pytest.approx(1.0, abs=0.03)
    for name, value in true.items():
        assert abs(values[name] - value) < 4.0 * stds[name] + 0.01 * abs(value), name


def test_rubber_that_gives_back_less_is_told_from_rubber_that_gives_back_all(found, model):
    """A law without a slope of unloading."""
    curve = fixed(stop_deformation=0.0, exponent=1.5, way=0.1) | {"force": Parameter(5e4, 1e3, 1e6)}
    first = evolve(model.joints[0], law="power_stop", parameters=curve)
    rubber = evolve(model, joints=(first, *model.joints[1:]))
    less = {"loss": Parameter(0.45), "unloading_length": Parameter(0.01)}
    proposal, values, stds, normalised = found(
        "plastic_unloading", with_factor(rubber, "first", "unloading_loss", less), rubber, LONGER
    )
    assert (proposal.form, proposal.location) == ("fading", {"joint": "first"})
    assert normalised == pytest.approx(1.0, abs=0.03)
    assert abs(values["loss"] - 0.45) < 4.0 * stds["loss"]


def test_a_sudden_loss_is_found_as_a_short_one(found, model):
    """Shorter than half a sample it cannot be searched for, and so a little of the jump is left."""
    proposal, values, _, normalised = found("fracture", broken(model))
    assert proposal.location == {"joint": "second"}
    assert values["loss"] == pytest.approx(0.6, abs=0.01)
    middle = values["softening_deformation"] + 0.5 * values["softening_length"]
    assert middle == pytest.approx(0.12, abs=1e-3)
    assert values["softening_length"] < 2e-3
    assert normalised < 1.25
