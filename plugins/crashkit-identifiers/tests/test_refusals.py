"""Models that not every method can take: each method works, or says in one line why not."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.model import Body, GivenForce, GivenMotion, Joint, Model, Parameter
from crashkit.protocols import Status
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_identifiers.cost import cost_at

TIMES = np.linspace(0.0, 0.1, 101)
ABSENT = dict.fromkeys(("unloading_stiffness", "rate_coefficient", "clearance", "tension"), Parameter(0.0, fixed=True))
METHODS = sorted(load().identifiers.keys() - {"gradient"})
"""Steepest descent takes any model, but in 15 steps it gets nowhere."""


def plane() -> Model:
    """One mass on two springs, the left one softer, that runs into a wall a little askew and yaws."""
    bodies = (
        Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True),
        Body("car", (-2.0, 0.1), (10.0, 0.0), Parameter(1000.0, fixed=True), inertia=(Parameter(500.0, fixed=True),)),
    )
    law = {"elastic_stiffness": 4e5, "crush_force": 3e4, "densification_deformation": 0.4, "densification_stiffness": 4e5}

    def free(share: float) -> dict[str, Parameter]:
        values = {name: value if name == "densification_deformation" else share * value for name, value in law.items()}
        return {name: Parameter(value, 0.1 * value, 10.0 * value) for name, value in values.items()}

    joints = tuple(
        Joint(f"rail_{side}", ("wall", "car"), "crush_plateau", free(share) | ABSENT, points=((0.0, y), (1.0, y)))
        for side, y, share in (("left", 0.5, 0.7), ("right", -0.5, 1.0))
    )
    return Model("askew", ("x", "y"), bodies, joints)


def misfit_of(model: Model) -> Misfit:
    """Film and accelerometers of every body, from 10 % below."""
    registry = load()
    motion = Simulator(model, registry.spring_laws).run(TIMES, step=5e-4)
    axes = list(model.axes)
    seen = motion.sel(axis=axes) if "orientation" not in motion else motion.drop_vars("orientation").sel(axis=axes)
    tree = toys.recording(seen)
    if len(axes) > 1:
        tree = tree.assign(film=xr.DataTree(two_markers(motion, axes)))
    return Misfit(toys.start_from(model, 0.9), {"run": tree}, registry.spring_laws, registry.observers)


def two_markers(motion: xr.Dataset, axes: list[str]) -> xr.Dataset:
    """Film of two points of the car, which show how it turns."""
    w, _, _, z = motion["orientation"].sel(body="car").transpose("quaternion", "time").values
    angle = 2.0 * np.arctan2(z, w)
    centre = motion["position"].sel(body="car", axis=axes).values
    arms = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # Of exact readings the noise that is found is the rounding of the processor, which is not the same on each.
    seen = np.round(np.stack([centre + arms, centre - arms], axis=1), 7)
    return xr.Dataset(
        {
            "position": (("time", "marker", "axis"), seen, {"units": "m"}),
            "marker_body": ("marker", ["car", "car"]),
            "marker_point": (("marker", "axis"), [[1.0, 0.0], [-1.0, 0.0]], {"units": "m"}),
            "position_std": ("marker", [1e-3, 1e-3], {"units": "m"}),
        },
        {"time": ("time", TIMES, {"units": "s"}), "marker": ["ahead", "behind"], "axis": axes},
        {"observer": "film"},
    )


def driven() -> Model:
    """The toy of two degrees whose rear mass is pushed."""
    model = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    push = GivenForce((0.0, 0.4), ((2e3,), (2e3,)))
    bodies = tuple(evolve(body, force=push) if body.name == "rear" else body for body in model.bodies)
    return evolve(model, bodies=bodies)


def on_rails() -> Model:
    """The toy of one degree against a wall that gives way as it is told."""
    model = toys.one_degree()
    wall = Body("wall", (0.0,), (0.0,), motion=GivenMotion((0.0, 0.2, 0.4), ((0.0,), (0.05,), (0.05,))))
    return evolve(model, bodies=(wall, model.body("front")))


REFUSED = {
    "plane": dict.fromkeys(("chebyshev", "optimal_filter"), "expected a model in one axis, found x, y"),
    "driven": dict.fromkeys(("chebyshev", "optimal_filter"), "only joints move, found a given motion or force of rear"),
    "on rails": dict.fromkeys(("chebyshev", "optimal_filter"), "only joints move, found a given motion or force of wall"),
}
MODELS = {"plane": plane, "driven": driven, "on rails": on_rails}


@pytest.mark.parametrize("kind", MODELS)
@pytest.mark.parametrize("method", METHODS)
def test_a_method_takes_a_model_or_says_why_not(method, kind):
    misfit, identifier = misfit_of(MODELS[kind]()), load().identifier(method)()
    if method in REFUSED[kind]:
        with pytest.raises(CrashkitError, match=f"^{method}: .*{REFUSED[kind][method]}; a method that simulates"):
            identifier.start(misfit)
        return
    state = identifier.start(misfit)
    for _ in range(15):
        state = identifier.step(misfit, state)
    assert state.status is not Status.FAILED
    assert identifier.finish(misfit, state).cost < 0.5 * cost_at(misfit, misfit.start())
