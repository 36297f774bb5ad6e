"""Instruments that read how bodies move let steps of the integration end anywhere, on bodies that turn as well."""

import numpy as np
import pytest
import xarray as xr

from crashkit.misfit import Misfit
from crashkit.model import Body, Joint, Model, Parameter

INSTANTS = np.arange(401) * 1e-4


@pytest.fixture
def swinging() -> Model:
    """A body in the plane that hangs on a spring at a point of its own."""
    wall = Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True)
    bob = Body("bob", (0.4, -0.5), (2.0, 0.5), Parameter(50.0, 5.0, 500.0), inertia=(Parameter(2.0, 0.2, 20.0),))
    rod = Joint("rod", ("wall", "bob"), "tie", {"stiffness": Parameter(4e5, 1e4, 1e7)}, points=((0.0, 0.0), (-0.3, 0.1)))
    return Model("swinging", ("x", "y"), (wall, bob), (rod,))


def instrument(quantity, channel, std, units, **attributes):
    """One channel off the centre of the body, in both axes."""
    return xr.DataTree(
        xr.Dataset(
            {
                quantity: (("time", channel, "axis"), np.zeros((len(INSTANTS), 1, 2)), {"units": units}),
                f"{channel}_body": (channel, ["bob"]),
                f"{channel}_point": ((channel, "axis"), [[0.2, -0.1]], {"units": "m"}),
                f"{quantity}_std": (channel, [std], {"units": units}),
            },
            {"time": ("time", INSTANTS, {"units": "s"}), channel: ["edge"], "axis": ["x", "y"]},
            attributes,
        )
    )


@pytest.fixture
def seen(registry, swinging):
    film = instrument("position", "marker", 1e-3, "m", observer="film")
    box = instrument("acceleration", "sensor", 1.0, "m s-2", observer="accelerometer", frame="body", channel_frequency_class=0)

    def make(step):
        run = xr.DataTree.from_dict({"film": film, "box": box})
        return Misfit(swinging, {"run": run}, registry.spring_laws, registry.observers).with_step(step)

    return make


def test_a_point_of_a_body_that_turns_is_read_between_steps(seen, registry, monkeypatch):
    between = seen(4e-4)
    assert between.predictor.longest_step > 0.03
    got = between.residual_and_jacobian(between.start())
    for name in ("film", "accelerometer"):
        monkeypatch.setattr(registry.observers[name], "of_motion", False)
    at_each = seen(4e-4)
    assert at_each.predictor.longest_step == pytest.approx(1e-4)
    for one, other in zip(got, at_each.residual_and_jacobian(at_each.start()), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-4 * np.abs(other).max())
