"""Whether a model and its recordings belong together."""

import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.misfit.together import check_together


@pytest.fixture
def run(recorded, model):
    return recorded(model, end=0.05)


@pytest.fixture
def check(registry):
    def together(model, **recordings) -> None:
        check_together(model, recordings, registry.observers, "model.toml")

    return together


def test_a_model_and_its_recordings(check, model, run, recorded, with_errors):
    faster = recorded(model, speed=1.2, end=0.05)
    sensor = str(run["film"]["marker"].values[0])
    wrong = with_errors(with_errors(model, "film", f"{sensor}/x", bias=0.01), "accelerometer", "", clock_offset=0.0)
    check(wrong, slow=run, fast=faster)


def test_every_run_is_told_what_it_has_that_the_model_lacks(check, model, run, changed):
    nobody = changed(run, "film", lambda film: film.assign(marker_body=film["marker_body"].copy(data=["engin"])))
    strange = changed(run, "film", lambda film: film.assign_attrs(observer="flim"))
    aside = changed(run, "film", lambda film: film.assign_coords(axis=["y"]))
    with pytest.raises(CrashkitError, match="film") as caught:
        check(model, a=nobody, b=strange, c=aside)
    first, second, third = str(caught.value).splitlines()
    assert first.startswith("a: film/marker_body: expected bodies of the model (") and first.endswith('found "engin"')
    assert second.startswith("b: film: expected an installed observer (") and second.endswith("found flim")
    assert third == "c: film/axis: expected the model's x, found y"


def test_an_instrument_of_the_model_that_no_run_has(check, model, run, with_errors):
    message = (
        r'^model.toml: instrument "akcelerometer": expected one of the instruments of the recordings, '
        r'found "akcelerometer" \(did you mean "accelerometer"\?\)$'
    )
    with pytest.raises(CrashkitError, match=message):
        check(with_errors(model, "akcelerometer", "", gain=1.0), run=run)


@pytest.mark.parametrize("sensor", ["tunnel", "tunnel/x"])
def test_a_sensor_of_the_model_that_no_run_has(check, model, run, with_errors, sensor):
    message = (
        rf'^model.toml: instrument "film" sensor "{sensor}": expected one of the sensors of film in the recordings '
        rf'\("front_marker"\), found "{sensor}"$'
    )
    with pytest.raises(CrashkitError, match=message):
        check(with_errors(model, "film", sensor, bias=0.1), run=run)


def test_a_copy_under_another_name_is_no_other_run(check, model, run):
    copy = run.copy(deep=True)
    copy.attrs["title"] = "another"
    with pytest.raises(CrashkitError, match=r"^copy: expected each run once, fitted or held out, found the values of run$"):
        check(model, run=run, copy=copy)
    copy["film"]["position"] = copy["film"]["position"] + np.float64(1e-6)
    check(model, run=run, copy=copy)


def test_a_state_of_a_body_that_the_model_lacks_is_warned_of(check, model, run, changed):
    def joined(initial):
        return xr.concat([initial, initial.isel(body=[0]).assign_coords(body=["trunk"])], "body", join="outer")

    more = changed(run, "initial", joined)
    message = r'^more: initial/body: expected bodies of the model \("wall", "front"\), found "trunk", which is not used$'
    with pytest.warns(UserWarning, match=message):
        check(model, run=run, more=more)
