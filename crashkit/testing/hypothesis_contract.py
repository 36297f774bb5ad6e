"""The contract of hypotheses: a proposal is a model that holds together, and without its physics is the one it came from."""

from collections.abc import Mapping, Sequence

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.mechanics import Engine, LawFunction, Simulator, compile_engine, functions_of
from crashkit.mechanics.laws.emit import emit
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.model.checks import model_faults
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit.testing import toys


class HypothesisContract:
    """Tests of a hypothesis; subclass it and give the fixture `hypothesis`.

    The model, its motion and the recordings are those of the two-degree toy, without noise; give fixtures of these names for a
    physics that needs others.

    Attributes:
        accuracy: of what the instruments read where the physics is absent, in standard deviations.
    """

    accuracy = 1e-5

    @pytest.fixture
    def hypothesis(self) -> Hypothesis:
        """The hypothesis under test."""
        pytest.fail("a hypothesis's contract needs a fixture `hypothesis` that returns an instance")

    @pytest.fixture
    def model(self) -> Model:
        """The model that may have left something out; its masses are known."""
        toy = toys.two_degrees()
        return toy.with_parameters({"body.rear.mass": evolve(toy.parameters()["body.rear.mass"], fixed=True)})

    @pytest.fixture
    def motion(self, model: Model) -> Sequence[xr.Dataset]:
        """Its motion in two runs, until both springs have opened again."""
        simulator, times = Simulator(model, load().spring_laws), np.linspace(0.0, 1.0, 501)
        return [simulator.run(times, initial=toys.initial_state(model, speed)) for speed in (1.0, 2.0)]

    @pytest.fixture
    def recordings(self, motion: Sequence[xr.Dataset]) -> Mapping[str, xr.DataTree]:
        """What instruments recorded of the two runs."""
        return {f"run_{number}": toys.recording(run) for number, run in enumerate(motion, 1)}

    @pytest.fixture
    def proposals(
        self, hypothesis: Hypothesis, model: Model, motion: Sequence[xr.Dataset], recordings: Mapping[str, xr.DataTree]
    ) -> list[Proposal]:
        """What the hypothesis proposes for them."""
        return hypothesis.propose(model, motion, list(recordings.values()))

    def test_proposes_something(self, proposals: list[Proposal]) -> None:
        assert proposals, "expected a proposal for this model and these recordings, found none"

    def test_the_sentence_takes_a_place(self, hypothesis: Hypothesis) -> None:
        sentence = hypothesis.sentence.format(place="joint first")
        assert "joint first" in sentence, f'the sentence: expected "{{place}}" in it, found "{hypothesis.sentence}"'

    def test_proposals_bear_the_physics_and_a_form(self, hypothesis: Hypothesis, proposals: list[Proposal]) -> None:
        for proposal in proposals:
            assert proposal.physics == hypothesis.physics, f"expected {hypothesis.physics}, found {proposal.physics}"
            assert proposal.form, "the form of a proposal: expected a word, found none"
        places = [(proposal.form, repr(proposal.location)) for proposal in proposals]
        assert len(set(places)) == len(places), "expected one proposal for each form and place, found two alike"

    def test_the_place_exists(self, proposals: list[Proposal], model: Model, recordings: Mapping[str, xr.DataTree]) -> None:
        known = _places(model, recordings)
        for proposal in proposals:
            keys = set(proposal.location) - {"instrument"} or {"instrument"}
            assert keys <= set(known), f"the location: expected one of {', '.join(known)}, found {proposal.location}"
            for kind, name in proposal.location.items():
                for entry in [name] if isinstance(name, str) else name:  # type: ignore[attr-defined]
                    assert entry in known[kind], f"{kind}: expected one of {', '.join(sorted(known[kind]))}, found {entry}"

    def test_the_new_parameters_are_free_and_new(self, proposals: list[Proposal], model: Model) -> None:
        for proposal in proposals:
            free = proposal.model.free_parameters()
            assert proposal.parameters, f"{_name(proposal)}: expected new parameters, found none"
            for path in proposal.parameters:
                assert path in free, f"{_name(proposal)}: expected {path} among the free parameters of its model"
                assert path not in model.free_parameters(), f"{_name(proposal)}: {path} is free already in the given model"
            lost = set(model.free_parameters()) - set(free)
            assert not lost, f"{_name(proposal)}: expected the given model's free parameters, lost {', '.join(sorted(lost))}"

    def test_fits_start_within_bounds(self, proposals: list[Proposal]) -> None:
        for proposal in proposals:
            assert proposal.starts, f"{_name(proposal)}: expected values to start from, found none"
            for start in proposal.starts:
                for path, parameter in proposal.model.at(start).free_parameters().items():
                    inside = parameter.lower <= parameter.value <= parameter.upper
                    assert inside, f"{_name(proposal)}: {path} starts outside its bounds, at {parameter.value:g}"

    def test_every_model_can_be_simulated(self, proposals: list[Proposal], recordings: Mapping[str, xr.DataTree]) -> None:
        for proposal in proposals:
            faults = model_faults(proposal.model, load().spring_laws)
            assert not faults, f"{_name(proposal)}: {faults[0]}"
        engine = _engine([proposal.model for proposal in proposals])
        for proposal in proposals:
            begun = proposal.model.at(next(iter(proposal.starts), {}))
            try:
                found = _readings(begun, recordings, engine)
            except CrashkitError as error:
                pytest.fail(f"{_name(proposal)}: expected a model that can be simulated, found {error}", pytrace=False)
            assert np.isfinite(found).all(), f"{_name(proposal)}: expected finite readings, found some that are not"

    def test_the_null_is_of_the_new_parameters(self, proposals: list[Proposal]) -> None:
        for proposal in proposals:
            strangers = set(proposal.null) - set(proposal.parameters)
            assert not strangers, f"{_name(proposal)}: expected a null of its own parameters, found {', '.join(strangers)}"

    def test_at_its_null_the_physics_is_absent(
        self, proposals: list[Proposal], model: Model, recordings: Mapping[str, xr.DataTree]
    ) -> None:
        nullable = [proposal for proposal in proposals if proposal.null]
        engine = _engine([model, *(proposal.model for proposal in nullable)])
        given = _readings(model, recordings, engine)
        for proposal in nullable:
            absent = proposal.model.at({**proposal.starts[0], **proposal.null})
            found = _readings(absent, recordings, engine)
            difference = float(np.abs(found - given).max())
            assert difference <= self.accuracy, (
                f"{_name(proposal)} at {dict(proposal.null)}: expected the readings of the given model, "
                f"found a difference of {difference:g} standard deviations"
            )


def _places(model: Model, recordings: Mapping[str, xr.DataTree]) -> dict[str, set[str]]:
    """What a location may name, by its key."""
    groups = [(name, group) for tree in recordings.values() for name, group in tree.children.items() if name != "initial"]
    bodies = {body.name for body in model.bodies}
    labels = [group.coords[dim].values.tolist() for _, group in groups for dim in ("sensor", "marker") if dim in group.coords]
    return {
        "joint": {joint.name for joint in model.joints},
        "body": bodies,
        "bodies": bodies,
        "sensor": {name for names in labels for name in names},
        "instrument": {name for name, _ in groups},
    }


def _engine(models: Sequence[Model]) -> Engine:
    """One engine for these models and for every law without a list, so that most hypotheses share its compilation."""
    laws = load().spring_laws
    plain = [LawFunction(law) for law in laws.values() if not any(spec.vector for spec in law.parameters)]
    needed = [function for model in models for function in functions_of(model, laws)]
    return compile_engine([*needed, *filter(_is_readable, plain)], len(models[0].axes))


def _is_readable(function: LawFunction) -> bool:
    """A law that the engine refuses is the business of its own tests, where the hypothesis does not need it."""
    try:
        emit(function)
    except CrashkitError:
        return False
    return True


def _readings(model: Model, recordings: Mapping[str, xr.DataTree], engine: Engine) -> np.ndarray:
    """What every instrument reads, in standard deviations from what it recorded."""
    registry = load()
    misfit = Misfit(model, recordings, registry.spring_laws, registry.observers, engine)
    return misfit.discrepancy(misfit.start())


def _name(proposal: Proposal) -> str:
    return f"{proposal.physics} ({proposal.form}) at {dict(proposal.location)}"
