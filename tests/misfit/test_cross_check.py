"""Film against accelerometers, for the same points."""

import numpy as np
import pytest
import xarray as xr
from scipy.interpolate import CubicSpline

from crashkit.errors import CrashkitError
from crashkit.misfit.cross_check import cross_check
from crashkit_accelerometers import Accelerometer, accelerometers, recorded, tumbling
from crashkit_cameras import Film

TIMES = np.arange(1201) * 1e-4
FRAMES = np.arange(120) * 1e-3
OBSERVERS = {"film": Film, "accelerometer": Accelerometer}
DIMS = ("time", "body", "axis")


def crash(bodies: tuple[str, ...] = ("car",)) -> xr.Dataset:
    """Bodies that are stopped from 15 m/s, each after its own fashion."""
    pulses = [(-280.0 - 60.0 * index) * np.sin(np.pi * np.minimum(TIMES / 0.09, 1.0)) ** 2 for index in range(len(bodies))]
    pulse = np.stack(pulses, axis=1)
    gained = CubicSpline(TIMES, pulse).antiderivative()
    position = 15.0 * TIMES[:, None] + gained.antiderivative()(TIMES)
    values = {"position": position, "velocity": 15.0 + gained(TIMES), "acceleration": pulse}
    return xr.Dataset(
        {name: (DIMS, value[..., None]) for name, value in values.items()},
        {"time": TIMES, "body": list(bodies), "axis": ["x"]},
    )


def run(seed=0, errors=None, cfc=180, film_std=1e-3, bodies=("car",), stated=True) -> xr.DataTree:
    """Two targets and an accelerometer on each body, with noise, and a few hidden frames."""
    motion, count = crash(bodies), len(bodies)
    film = xr.Dataset(
        {
            "position": (("time", "marker", "axis"), np.zeros((120, 2 * count, 1)), {"units": "m"}),
            "marker_body": ("marker", [*bodies, *bodies]),
            "marker_point": (("marker", "axis"), np.arange(2.0 * count)[:, None]),
            "position_std": ("marker", np.full(2 * count, film_std)),
        },
        {"time": FRAMES, "marker": [f"m{index}" for index in range(2 * count)], "axis": ["x"]},
        {"observer": "film"},
    )
    seen = Film().predict(motion, film)["position"].values
    seen += film_std * np.random.default_rng(1000 + seed).normal(size=seen.shape)
    seen[40:46, 0] = np.nan
    accelerometer = xr.Dataset(
        {
            "acceleration": (("time", "sensor", "axis"), np.zeros((1201, count, 1)), {"units": "m s-2"}),
            "sensor_body": ("sensor", list(bodies)),
            "sensor_point": (("sensor", "axis"), np.zeros((count, 1))),
            "acceleration_std": ("sensor", np.full(count, 3.0)),
        },
        {"time": TIMES, "sensor": [f"{body}_acc" for body in bodies], "axis": ["x"]},
        {"observer": "accelerometer", "channel_frequency_class": cfc, "frame": "laboratory"},
    )
    felt = recorded(Accelerometer(), motion, accelerometer, errors, seed=seed)
    state = xr.Dataset(
        {"position": (("body", "axis"), np.zeros((count, 1))), "velocity": (("body", "axis"), np.full((count, 1), 15.0))},
        {"body": list(bodies), "axis": ["x"]},
    )
    film = film.assign(position=(film["position"].dims, seen, {"units": "m"}))
    groups = {"film": film if stated else film.drop_vars("position_std"), "accelerometer": felt, "initial": state}
    return xr.DataTree.from_dict(groups)


@pytest.mark.parametrize("cfc", [0, 180])
@pytest.mark.parametrize("known_velocity", [False, True])
def test_chi_square_of_instruments_that_agree_is_as_large_as_it_says(cfc, known_velocity) -> None:
    checks = [cross_check(run(seed, cfc=cfc), OBSERVERS, known_velocity=known_velocity) for seed in range(8)]
    freedom = int(checks[0]["degrees_of_freedom"][0])
    assert freedom == 24 - (not known_velocity)
    mean = np.mean([float(check["chi_square"][0]) for check in checks])
    assert mean == pytest.approx(freedom, abs=4.0 * np.sqrt(2.0 * freedom / 8))
    assert all(check["consistent"].all() for check in checks)


def test_the_difference_lies_within_its_band() -> None:
    ratios = []
    for seed in range(8):
        check = cross_check(run(seed), OBSERVERS)
        ratios.append((check["difference"] / check["difference_std"]).values)
    assert np.nanmean(np.abs(ratios) < 1.96) == pytest.approx(0.95, abs=0.06)


@pytest.mark.parametrize(
    "errors",
    [
        {"car_acc": {"gain": 1.03}},
        {"car_acc": {"bias": 5.0}},
        {"": {"clock_offset": 1.5e-3}},
        {"car_acc": {"saturation": 250.0}},
    ],
)
def test_a_sensor_that_is_wrong_contradicts_the_film(errors) -> None:
    check = cross_check(run(errors=errors), OBSERVERS, known_velocity=True)
    assert not check["consistent"].any()
    assert "contradict each other" in str(check["sentence"][0].values)


def test_a_gain_that_can_be_seen_is_seen_and_a_smaller_one_is_not() -> None:
    detectable = float(cross_check(run(), OBSERVERS)["detectable_gain"][0])
    assert not cross_check(run(errors={"": {"gain": 1.0 + 3.0 * detectable}}), OBSERVERS)["consistent"].any()
    assert cross_check(run(errors={"": {"gain": 1.0 + 0.1 * detectable}}), OBSERVERS)["consistent"].all()


def test_a_wrong_initial_velocity_matters_only_where_it_is_held_to() -> None:
    recording = run()
    recording["initial"]["velocity"] = recording["initial"]["velocity"] + 0.3
    assert cross_check(recording, OBSERVERS)["consistent"].all()
    assert not cross_check(recording, OBSERVERS, known_velocity=True)["consistent"].any()


def test_each_body_has_its_own_verdict() -> None:
    check = cross_check(run(bodies=("car", "engine"), errors={"engine_acc": {"gain": 1.1}}), OBSERVERS)
    assert dict(zip(check["body"].values, check["consistent"].values, strict=True)) == {"car": True, "engine": False}
    assert sorted(check["marker"].values) == ["m0", "m1", "m2", "m3"]


def test_displacements_are_from_the_first_frame_and_hidden_frames_stay_hidden() -> None:
    check = cross_check(run(film_std=1e-5), OBSERVERS)
    assert check["film"].dims == ("time", "marker", "axis")
    np.testing.assert_array_equal(check["accelerometer"][0], 0.0)
    assert np.isnan(check["film"][40:46, 0]).all()
    assert np.isfinite(check["accelerometer"]).all()
    truth = crash()["position"].interp(time=FRAMES).values[:, 0]
    np.testing.assert_allclose(check["film"][50:, 0], truth[50:], atol=2e-4)


def test_noise_that_is_not_stated_is_estimated() -> None:
    check = cross_check(run(stated=False), OBSERVERS)
    np.testing.assert_allclose(check["film_std"], 1e-3, rtol=0.4)
    assert check["consistent"].all()


def test_instruments_that_share_no_body_are_refused() -> None:
    recording = run()
    recording["film"] = run(bodies=("engine",))["film"]
    with pytest.raises(CrashkitError, match="expected a body that both film and accelerometer watch"):
        cross_check(recording, OBSERVERS)


def test_a_group_that_is_not_there_is_named() -> None:
    with pytest.raises(CrashkitError, match="expected a group camera, found film, accelerometer, initial"):
        cross_check(run(), OBSERVERS, film="camera")


def test_a_group_that_is_misspelt_is_guessed() -> None:
    with pytest.raises(CrashkitError, match=r'found film, accelerometer, initial \(did you mean "film"\?\)$'):
        cross_check(run(), OBSERVERS, film="flim")


@pytest.mark.parametrize("name", ["film", "accelerometer"])
def test_an_instrument_is_not_compared_with_itself(name) -> None:
    with pytest.raises(CrashkitError, match=f"^expected film and accelerometers, found {name} and {name}, both of one kind$"):
        cross_check(run(), OBSERVERS, film=name, accelerometer=name)


def test_film_gives_no_accelerations() -> None:
    with pytest.raises(CrashkitError, match="^film: expected an instrument that gives accelerations, found a film$"):
        cross_check(run(), OBSERVERS, film="accelerometer", accelerometer="film")


def test_bodies_that_are_not_compared_are_named() -> None:
    assert cross_check(run(), OBSERVERS).attrs["not_compared"] == ""
    recording = run(bodies=("car", "engine"))
    film = recording["film"].to_dataset()
    recording["film"] = film.assign(marker_body=("marker", ["car", "engin", "car", "engin"]))
    check = cross_check(recording, OBSERVERS)
    assert check["body"].values.tolist() == ["car"]
    assert check.attrs["not_compared"] == "not compared: engin of film; engine of accelerometer"


def test_a_group_that_nobody_understands_is_named() -> None:
    with pytest.raises(CrashkitError, match=r"accelerometer: expected an installed observer \(film\), found accelerometer"):
        cross_check(run(), {"film": Film})


def test_a_velocity_that_is_not_recorded_cannot_be_known() -> None:
    recording = run()
    del recording["initial"]
    assert cross_check(recording, OBSERVERS)["consistent"].all()
    with pytest.raises(CrashkitError, match="expected the velocity of car in the group initial, found none"):
        cross_check(recording, OBSERVERS, known_velocity=True)


def test_too_few_frames_are_refused() -> None:
    recording = run()
    recording["film"]["position"][7:] = np.nan
    with pytest.raises(CrashkitError, match="expected at least 8 frames that the accelerometers cover, found 7"):
        cross_check(recording, OBSERVERS)


@pytest.mark.parametrize("tilt", [0.0, 0.05])
def test_a_body_that_turns_is_followed_by_its_markers(tilt) -> None:
    """Two biaxial sensors in the plane, two targets away from them."""
    motion = tumbling(TIMES, 0.3, 0.0, 0.0)
    points = {"front": (0.6, 0.1), "rear": (-0.5, 0.0)}
    sensors = accelerometers(points, TIMES, "car", "xy", std=2.0, channel_frequency_class=180)
    felt = recorded(Accelerometer(), motion, sensors, {"front": {"tilt_z": tilt}})
    film = xr.Dataset(
        {
            "position": (("time", "marker", "axis"), np.zeros((120, 2, 2)), {"units": "m"}),
            "marker_body": ("marker", ["car", "car"]),
            "marker_point": (("marker", "axis"), [[0.9, 0.5], [-0.7, -0.4]]),
            "position_std": ("marker", [1e-3, 1e-3]),
        },
        {"time": FRAMES, "marker": ["bonnet", "boot"], "axis": ["x", "y"]},
        {"observer": "film"},
    )
    seen = recorded(Film(), motion, film)
    check = cross_check(xr.DataTree.from_dict({"film": seen, "accelerometer": felt}), OBSERVERS)
    assert bool(check["consistent"][0]) == (tilt == 0.0)
