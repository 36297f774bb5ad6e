"""A body that turns acts back on its joints as a lighter one that carries the rest of it on a spring."""

import math

import numpy as np
import pytest
from attrs import evolve
from scipy.integrate import solve_ivp

from crashkit.api import workshop
from crashkit.mechanics import Simulator
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_hypotheses.rotation import Rotation

ACTING_BACK = "rocking, acting back"
TIMES = np.linspace(0.0, 0.2, 401)
MASS, INERTIA, HELD, ARM, HEIGHT = 400.0, 30.0, 9e4, 0.12, 0.3
"""Of a body that pitches, kg, kg m2, N m rad-1; how far above its joint, and its marker, is the centre of mass, m."""
STIFFNESS, SPEED = 4e5, 3.0
"""N m-1 of the joint that stops it, m s-1."""


def claims(model, runs, body):
    found = Rotation().propose(model, runs, [toys.recording(run) for run in runs])
    return {claim.form: claim for claim in found if claim.location == {"body": body}}


@pytest.fixture(scope="module")
def toy_runs(engine):
    model = toys.two_degrees()
    return [Simulator(model, load().spring_laws, engine).run(TIMES, initial=toys.initial_state(model, 1.0))]


@pytest.fixture(scope="module")
def body_on_a_spring():
    """The same body as a line knows it."""
    spring = {"stiffness": STIFFNESS, "damping": 0.0, "holds": 1.0}
    wall = Body("wall", (0.0,), (0.0,), fixed=True)
    body = Body("body", (-1.0,), (SPEED,), Parameter(MASS, 1.0, 1e3, fixed=True))
    stop = Joint("stop", ("wall", "body"), "tie", {name: Parameter(value, fixed=True) for name, value in spring.items()})
    return Model("body on a spring", ("x",), (wall, body), (stop,))


def pitching():
    """Where its joint and its marker are: x of its centre of mass, and the angle that a force ahead of it turns it by."""

    def rates(_, state):
        x, angle, *speeds = state
        force = -STIFFNESS * (x + ARM * angle)
        return [*speeds, force / MASS, (ARM * force - HELD * angle) / INERTIA]

    solved = solve_ivp(rates, (0.0, TIMES[-1]), [0.0, 0.0, SPEED, 0.0], t_eval=TIMES, rtol=1e-10, atol=1e-12)
    x, angle = solved.y[:2]
    return x + ARM * angle - 1.0, x + HEIGHT * angle - 1.0


def test_a_claim_moves_as_a_body_that_pitches_and_its_marker_reads_what_that_shows(body_on_a_spring):
    run = Simulator(body_on_a_spring, load().spring_laws, None).run(TIMES)
    claim = claims(body_on_a_spring, [run], "body")[ACTING_BACK]
    about_joint = INERTIA + MASS * ARM**2
    rest = MASS * MASS * ARM**2 / about_joint
    values = {
        "body.body.mass": MASS - rest,
        "body.body_load.mass": rest,
        "joint.body_load_tie.stiffness": rest * HELD / about_joint,
        "joint.body_load_tie.damping": 0.0,
    }
    equipped = workshop().equipped([claim.model])
    moved = Simulator(claim.model.with_values(values), equipped.laws, equipped.engine).run(TIMES)
    joint, marker = pitching()
    np.testing.assert_allclose(moved["position"].sel(body="body").squeeze(), joint, atol=2e-5)
    errors = {
        "rocking_share": (ARM - HEIGHT) * ARM * MASS / about_joint,
        "rocking_frequency": math.sqrt(HELD / about_joint) / (2.0 * math.pi),
        "rocking_damping": 0.0,
    }
    film = toys.recording(moved)["film"].to_dataset(inherit=False)
    read = equipped.observers["film"]().predict(moved, film, {"body_marker": errors})
    np.testing.assert_allclose(read["position"].sel(marker="body_marker").squeeze(), marker, atol=5e-5)


def test_the_mass_that_was_weighed_is_shared_by_the_body_and_the_rest_of_it(body_on_a_spring):
    run = Simulator(body_on_a_spring, load().spring_laws, None).run(TIMES)
    claim = claims(body_on_a_spring, [run], "body")[ACTING_BACK]
    (together,) = claim.model.sums
    assert (set(together.paths), together.total) == ({"body.body.mass", "body.body_load.mass"}, MASS)
    for start in claim.starts:
        rest = start["body.body_load.mass"]
        assert start["body.body.mass"] + rest == pytest.approx(MASS)
        swings = math.sqrt(start["joint.body_load_tie.stiffness"] / rest) / (2.0 * math.pi)
        assert swings == pytest.approx(start["instrument.film.body_marker.rocking_frequency"])


def test_a_mass_that_is_identified_anyway_is_no_number_of_the_claim(toy_runs):
    model = toys.two_degrees()
    claim = claims(model, toy_runs, "rear")[ACTING_BACK]
    assert not model.parameters()["body.rear.mass"].fixed
    assert "body.rear.mass" not in claim.parameters and not claim.model.sums
    assert claim.model.parameters()["body.rear.mass"] == model.parameters()["body.rear.mass"]


def test_of_a_load_only_its_sensors_say_that_it_turns(toy_runs):
    model = toys.two_degrees()
    riding = evolve(model, bodies=tuple(evolve(b, carrier="front") if b.name == "rear" else b for b in model.bodies))
    assert list(claims(riding, toy_runs, "rear")) == ["rocking"]
    assert list(claims(riding, toy_runs, "front")) == ["rocking", ACTING_BACK]
