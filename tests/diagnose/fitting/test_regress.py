"""Where measured accelerations lead a claim."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting import regress
from crashkit.diagnose.fitting.from_given import FromGiven
from crashkit.diagnose.fitting.regress import AT_A_TIME, STEPS, opened, regressed, simulated
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import rivals as naming
from crashkit.diagnose.name.rivals import further_rivals
from crashkit.errors import CrashkitError
from crashkit.model import Body, Joint, Parameter
from crashkit.model.edit import with_body, with_joint

FADING = {"fresh_share": 0.6, "relaxation_time": 0.03, "holds": 1.0}
LOAD = {"mass": 150.0, "stiffness": 5e4, "damping": 500.0}
STOP = {"stiffness": 3e5, "stop_deformation": 0.4}
SPEEDS = {"slow": 0.9, "fast": 1.3}


class NoMotion:
    """An identifier that finds no motion measured."""

    def start(self, misfit):
        raise CrashkitError("expected film or accelerometers")


def silent(doing, share):
    """Nobody listens."""


@pytest.fixture
def claims(workshop):
    """Claims of some physics."""

    def of(given, *physics):
        return [p for p in propose_all(workshop, given) if p.physics in physics and not p.refined]

    return of


@pytest.fixture
def led(workshop):
    """Where the equations of motion lead claims."""

    def of(given, claims):
        equipped = workshop.equipped([p.model for p in claims])
        return regressed(equipped, given, claims, opened(equipped, given, claims, silent), silent)

    return of


@pytest.fixture
def off(model, misfit, recorded):
    """A model with its own numbers a quarter off, and recordings of what another one does."""

    def of(true):
        rough = {path: p.value * (1.25 if i % 2 else 0.8) for i, (path, p) in enumerate(model.free_parameters().items())}
        recordings = {name: told_of_front(recorded(true, speed)) for name, speed in SPEEDS.items()}
        return misfit(model.with_values(rough), **recordings)

    return of


def told_of_front(recording):
    """What a recording tells of the body in front."""
    parts = {}
    for name, channel in (("film", "marker_body"), ("accelerometer", "sensor_body"), ("initial", "body")):
        group = recording[name].to_dataset(inherit=False)
        parts[name] = xr.DataTree(group.isel({group[channel].dims[0]: group[channel].values == "front"}))
    return recording.assign(parts)


@pytest.fixture
def rough(model, off):
    """Without the stop that was hit."""
    return off(with_law(model, "+ linear_stop", STOP))


def with_law(model, addition, values):
    """The model with one more law in its first joint."""
    fixed = {name: Parameter(value, fixed=True) for name, value in values.items()}
    first, *others = model.joints
    changed = evolve(first, law=f"{first.law} {addition}", parameters={**first.parameters, **fixed})
    return evolve(model, joints=(changed, *others))


def best_of(entrants):
    return min(entrants, key=lambda entrant: entrant[1].state.cost)


def test_a_stop_is_found_from_rough_numbers(rough, claims, led):
    proposal, search = best_of(led(rough, claims(rough, "bottoming", "peak_load", "viscous_damping")))
    values = search.misfit.values(search.point)
    assert (proposal.physics, proposal.form) == ("bottoming", "line")
    assert search.normalised == pytest.approx(1.0, abs=0.05)
    # Two lines in one curve: which of them is the stop, no recording tells.
    lines = values["joint.first.stop_deformation"], values["joint.first.densification_deformation"]
    assert min(lines) == pytest.approx(STOP["stop_deformation"], rel=0.02)


def test_a_force_that_fades_is_found_by_what_it_remembers(model, off, claims, led):
    given = off(with_law(model, "~ quasi_linear", FADING))
    proposal, search = best_of(led(given, claims(given, "relaxation", "peak_load", "viscous_damping")))
    values = search.misfit.values(search.point)
    assert (proposal.physics, search.normalised) == ("relaxation", pytest.approx(1.0, abs=0.05))
    assert values["joint.first.relaxation_time"] == pytest.approx(FADING["relaxation_time"], rel=0.2)


def test_a_load_that_no_instrument_sees_is_simulated_beside_its_carrier(model, off, claims, led):
    carrier = model.joints[0].bodies[1]
    place = {"position": model.body(carrier).position, "velocity": model.body(carrier).velocity}
    loaded = with_body(model, Body("load", **place, mass=Parameter(LOAD["mass"], fixed=True), carrier=carrier))
    strap = {name: Parameter(LOAD[name], fixed=True) for name in ("stiffness", "damping")}
    tied = Joint("strap", (carrier, "load"), "tie", strap)
    given = off(with_joint(loaded, tied))
    proposal, search = best_of(led(given, claims(given, "carried_load", "peak_load", "viscous_damping")))
    assert (proposal.physics, search.normalised) == ("carried_load", pytest.approx(1.0, abs=0.05))


def test_an_instrument_has_no_equation_of_motion(rough, claims, led):
    told = claims(rough, "gain_error", "peak_load")
    assert {proposal.physics for proposal in told} == {"gain_error", "peak_load"}
    assert {proposal.physics for proposal, _ in led(rough, told)} == {"peak_load"}


def test_only_what_has_no_equation_of_motion_is_simulated_from_the_given_values(workshop, rough, claims, monkeypatch):
    proposals = claims(rough, "bias", "viscous_damping", "peak_load")  # none of which is the stop
    scored = []
    monkeypatch.setattr(naming, "scores", lambda *args: scored.extend(args[2]) or [])
    further_rivals(workshop, rough, FromGiven(workshop, rough, proposals, silent), proposals, [], True, silent)
    assert {p.physics for p in scored} == {"bias"}


def test_all_are_simulated_where_no_motion_was_measured(workshop, rough, claims, monkeypatch):
    unseen = evolve(workshop, starter=NoMotion())
    scored = []
    monkeypatch.setattr(naming, "scores", lambda *args: scored.extend(args[2]) or [])
    proposals = claims(rough, "bias", "viscous_damping")
    further_rivals(unseen, rough, FromGiven(unseen, rough, proposals, silent), proposals, [], True, silent)
    assert {p.physics for p in scored} == {"bias", "viscous_damping"}


@pytest.fixture
def shown(monkeypatch):
    """The misfits whose recordings were shown little by little, which leads nowhere."""
    asked = []
    monkeypatch.setattr(regress, "spread", lambda function, items: [function(item) for item in items])

    def nowhere(identifier, misfit):
        asked.append(misfit)
        return {name: 1.5 * value for name, value in misfit.values(misfit.start()).items()}

    monkeypatch.setattr(regress, "grown", nowhere)
    return asked


@pytest.mark.parametrize(("known", "count"), [((True, True), 0), ((False, True), 0), ((False, False), 2)])
def test_what_a_known_claim_explains_at_once_is_not_shown_little_by_little(
    model, misfit, recorded, workshop, shown, known, count
):
    right = misfit(model, run=recorded(model))
    searches = simulated(workshop.identifier, [right, right], known, lambda share: None)
    assert len(shown) == count
    assert max(search.normalised for search in searches) < 1.05  # whatever that led to


def test_the_most_promising_are_shown_the_recordings_first_and_known_ones_before_estimates(rough, workshop, shown):
    steps = [rough.with_values({"joint.first.crush_force": force}) for force in (5e3, 3e4, 6e4, 9e4, 1e5, 2e5)]
    known = [index != 2 for index in range(len(steps))]
    ends = simulated(workshop.identifier, steps, known, lambda share: None)
    costs = [begin(workshop.identifier, one).advance(STEPS).state.cost for one in steps]
    order = sorted(range(len(steps)), key=lambda one: (not known[one], costs[one]))
    assert len(shown) == len(steps) > AT_A_TIME
    assert [one.values(one.start()) for one in shown] == [steps[one].values(steps[one].start()) for one in order]
    assert all(end.normalised <= begin(workshop.identifier, one).normalised for end, one in zip(ends, steps, strict=True))


@pytest.mark.parametrize(("apart", "count"), [(np.inf, AT_A_TIME), (0.0, 6)])
def test_beside_one_that_stands_out_only_the_most_promising_are_shown_the_recordings(
    rough, workshop, shown, monkeypatch, apart, count
):
    monkeypatch.setattr(regress, "APART", apart)
    steps = [rough.with_values({"joint.first.crush_force": force}) for force in (5e3, 3e4, 6e4, 9e4, 1e5, 2e5)]
    simulated(workshop.identifier, steps, [True] * len(steps), lambda share: None)
    assert len(shown) == count


@pytest.mark.parametrize(("left", "is_apart"), [([2.0, 9.0, 14.0], True), ([4.0, 9.0, 14.0], False), ([2.0], False)])
def test_a_fit_stands_out_that_leaves_next_to_nothing_of_what_most_do(left, is_apart):
    fits = [SimpleNamespace(excess=normalised**2 - 1.0) for normalised in left]
    assert regress._stands_out(fits) is is_apart


def test_while_little_has_been_seen_all_numbers_are_believed_to_be_where_they_are(rough, workshop, shown):
    given = rough.with_prior(0.3)
    moved = given.with_values({"joint.first.crush_force": 7e4})
    simulated(workshop.identifier, [moved], [True], lambda share: None)
    assert moved.prior.centres["joint.first.crush_force"] != pytest.approx(7e4)
    assert shown[0].prior.centres["joint.first.crush_force"] == pytest.approx(7e4)
    assert shown[0].prior.std == 0.3
