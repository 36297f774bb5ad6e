"""Points of bodies that turn in the plane are read without a Dataset, and between steps; as the observers say."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.misfit import Misfit, predictor
from crashkit.misfit.readout import Readout
from crashkit.misfit.turning_readout import TurningReadout
from crashkit.model import Body, InstrumentErrors, Joint, Model, Parameter

INSTANTS = np.arange(401) * 1e-4
BEFORE = 0.01
"""s, from before contact."""
READOUTS = [TurningReadout, TurningReadout, Readout]
POINTS = {"x": 0.2, "z": -0.1}


@pytest.fixture
def swinging() -> Model:
    """A body in the plane that turns already, and hangs on a spring at a point of its own."""
    wall = Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True)
    bob = Body(
        "bob",
        (0.4, -0.5),
        (2.0, 0.5),
        Parameter(50.0, 5.0, 500.0),
        inertia=(Parameter(2.0, 0.2, 20.0),),
        orientation=(0.4,),
        angular_velocity=(3.0,),
    )
    rod = Joint("rod", ("wall", "bob"), "tie", {"stiffness": Parameter(4e5, 1e4, 1e7)}, points=((0.0, 0.0), (-0.3, 0.1)))
    return Model("swinging", ("x", "z"), (wall, bob), (rod,))


def instrument(quantity, channel, std, units, axes, begins=-BEFORE, **attributes):
    """One channel off the centre of the body, in some axes, from a time on, s."""
    return xr.DataTree(
        xr.Dataset(
            {
                quantity: (("time", channel, "axis"), np.zeros((len(INSTANTS), 1, len(axes))), {"units": units}),
                f"{channel}_body": (channel, ["bob"]),
                f"{channel}_point": ((channel, "axis"), [[POINTS[axis] for axis in axes]], {"units": "m"}),
                f"{quantity}_std": (channel, [std], {"units": units}),
            },
            {"time": ("time", INSTANTS + begins, {"units": "s"}), channel: ["edge"], "axis": list(axes)},
            attributes,
        )
    )


@pytest.fixture
def seen(registry, swinging):
    def make(axes="xz", frame="body", frequency_class=0, model=swinging, begins=-BEFORE):
        told = {"observer": "accelerometer", "frame": frame, "channel_frequency_class": frequency_class}
        film = instrument("position", "marker", 1e-3, "m", axes, observer="film")
        box = instrument("acceleration", "sensor", 1.0, "m s-2", axes, begins, **told)
        cell = instrument("force", "sensor", 10.0, "N", axes, observer="load_cell")
        run = xr.DataTree.from_dict({"film": film, "box": box, "cell": cell})
        return Misfit(model, {"run": run}, registry.spring_laws, registry.observers).with_step(4e-4)

    return make


def told_by(misfit):
    start = misfit.start()
    return misfit.residual(start), *misfit.residual_and_jacobian(start)


@pytest.mark.parametrize("axes", ["xz", "z"])
@pytest.mark.parametrize(
    ("frame", "frequency_class", "begins"),
    [("body", 0, -BEFORE), ("laboratory", 0, -BEFORE), ("body", 180, -BEFORE), ("body", 180, 0.01)],
)
def test_a_point_is_read_as_its_observer_says(seen, monkeypatch, axes, frame, frequency_class, begins):
    fast = seen(axes, frame, frequency_class, begins=begins)
    assert [type(one) for one in fast.predictor._readouts] == READOUTS
    got = told_by(fast)
    monkeypatch.setattr(predictor, "readout_of", lambda *_: None)
    for one, other in zip(got, told_by(seen(axes, frame, frequency_class, begins=begins)), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9 * np.abs(other).max())


WRONG = {
    "cell": {"gain": 1.1, "bias": 30.0, "tilt_y": 0.2, "transverse_x": 0.1, "saturation": 500.0, "clock_offset": 1e-3},
    "film": {"gain": 1.1, "bias": 0.02, "clock_offset": 1e-3, "clock_rate": 0.01, "rocking_share": 0.3},
    "box": {
        "gain": 1.1,
        "bias": 3.0,
        "bias_drift": 20.0,
        "tilt_y": 0.2,
        "transverse_x": 0.1,
        "transverse_z": -0.2,
        "quadratic": 1e-4,
        "hysteresis": 2.0,
        "saturation": 300.0,
        "resonance_share": 0.4,
        "clock_offset": 1e-3,
    },
}
WRONG_NAMES = [(instrument, name) for instrument, errors in WRONG.items() for name in errors]


def with_errors(model, instrument, **errors):
    free = {name: Parameter(value, value - 1.0 - abs(value), value + 1.0 + abs(value)) for name, value in errors.items()}
    place = "" if set(errors) & {"clock_offset", "clock_rate"} else "edge"
    return evolve(model, instruments=(InstrumentErrors(instrument, place, free),))


@pytest.mark.parametrize(("name", "error"), WRONG_NAMES)
def test_a_point_is_misread_as_its_observer_says(seen, swinging, monkeypatch, name, error):
    model = with_errors(swinging, name, **{error: WRONG[name][error]})
    fast = seen(model=model)
    assert [type(one) for one in fast.predictor._readouts] == READOUTS
    got = told_by(fast)
    monkeypatch.setattr(predictor, "readout_of", lambda *_: None)
    for one, other in zip(got, told_by(seen(model=model)), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9 * np.abs(other).max())


@pytest.mark.parametrize(("axes", "error"), [("z", "gain"), ("xz", "position_x")])
def test_what_acts_across_or_elsewhere_is_asked_of_the_observer(seen, swinging, axes, error):
    one = seen(axes, model=with_errors(swinging, "box", **{error: 0.1}))
    assert one.predictor._readouts[1] is None
    assert np.isfinite(one.residual(one.start())).all()


def test_a_point_is_read_between_steps(seen, monkeypatch):
    monkeypatch.setattr(predictor, "readout_of", lambda *_: None)
    between = seen()
    assert between.predictor.longest_step == pytest.approx(INSTANTS[-1] - BEFORE)
    got = told_by(between)
    monkeypatch.setattr(predictor.Predictor, "_steps_end_at_all", True)
    at_each = seen()
    assert at_each.predictor.longest_step == pytest.approx(1e-4)
    for one, other in zip(got, told_by(at_each), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-3, atol=1e-3 * np.abs(other).max())


def test_where_no_number_of_the_structure_is_free_there_are_no_columns(seen, swinging):
    known = {path: evolve(one, fixed=True) for path, one in swinging.free_parameters().items()}
    _, jacobian = (one := seen(model=swinging.with_parameters(known))).residual_and_jacobian(one.start())
    assert jacobian.shape == (6 * len(INSTANTS), 0)
