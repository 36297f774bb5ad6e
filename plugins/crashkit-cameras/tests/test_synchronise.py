"""Clocks of views, found by diodes, by the motion that they see, and by accelerometers."""

import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit_cameras import Laboratory, make_laboratory, triangulate
from crashkit_cameras.synchronise import (
    corrected_time,
    resampled,
    synchronise_by_diode,
    synchronise_views,
    synchronise_with_accelerometer,
    synchronised,
)

STAMPS = np.arange(60) * 1e-3
POINTS = np.array([[0.5, 0.4, -0.2], [-0.3, 0.1, 0.5], [-0.6, -0.3, 0.0], [0.2, -0.5, 0.3]])


def places(times: np.ndarray) -> np.ndarray:
    """Four markers of a car that is braked and bounces, (time, marker, 3), m."""
    car = np.stack([-0.4 + 14 * times - 180 * times**2, 0.1 * np.sin(60 * times), 0.05 * np.sin(90 * times)], axis=1)
    return car[:, None] + POINTS


def filmed(lab: Laboratory, offset: float, rate: float, random: np.random.Generator | None) -> xr.Dataset:
    """A camera group whose second view has a clock of its own."""
    epoch = 0.5 * (STAMPS[0] + STAMPS[-1])
    group = lab.record_points(places(STAMPS), STAMPS, random)
    late = lab.record_points(places(STAMPS - offset - rate * (STAMPS - epoch)), STAMPS, random)
    group["image_position"][:, 1] = late["image_position"][:, 1]
    return group


def test_views_are_synchronised_by_the_motion_to_a_fiftieth_of_a_frame() -> None:
    lab = make_laboratory(2, 20, seed=1)
    clock = synchronise_views(filmed(lab, 0.00337, 2e-4, np.random.default_rng(0)), reference="camera_1").sel(view="camera_2")
    assert abs(float(clock["offset"]) - 0.00337) < 2e-5
    assert abs(float(clock["offset"]) - 0.00337) < 4 * float(clock["offset_std"]) < 4e-4
    assert abs(float(clock["rate"]) - 2e-4) < 4 * float(clock["rate_std"]) < 4e-3


def test_the_stated_deviation_of_a_clock_is_that_of_its_errors() -> None:
    lab, deviations = make_laboratory(2, 20, seed=2), []
    for seed in range(6):
        clock = synchronise_views(filmed(lab, -0.0021, 0.0, np.random.default_rng(seed)), within=0.004).isel(view=1)
        deviations.append((float(clock["offset"]) + 0.0021) / float(clock["offset_std"]))
    assert 0.3 < np.sqrt(np.mean(np.square(deviations))) < 1.8


def test_views_are_brought_to_the_same_times() -> None:
    lab = make_laboratory(2, 20, seed=1)
    group = filmed(lab, 0.00337, 0.0, None)
    clock = synchronise_views(group, drift=1e-6)
    moved = resampled(group, clock)
    known = np.isfinite(moved["image_position"]).all(["view", "marker", "image_axis"]).values
    assert known.sum() >= 55
    before, after = (triangulate(one)["position"].values[known] - places(STAMPS)[known] for one in (group, moved))
    assert np.sqrt(np.mean(after**2)) < 1e-3
    assert not np.sqrt(np.nanmean(before**2)) < 5e-3


def test_what_does_not_move_has_no_clock() -> None:
    lab = make_laboratory(2, 20, seed=1)
    group = lab.record_points(np.tile(POINTS, (40, 1, 1)), STAMPS[:40], np.random.default_rng(1))
    clock = synchronise_views(group, within=0.005)
    assert clock["determined"].values.tolist() == [True, False]
    with pytest.raises(CrashkitError, match="clock: expected one that could be determined, found camera_2, which could not"):
        resampled(group, clock)


def blinking(offset: float, rate: float, duty: float = 0.5, frequency: float = 100.0) -> xr.DataArray:
    epoch = 0.5 * (STAMPS[0] + STAMPS[-1])
    times = np.stack([STAMPS, STAMPS - offset - rate * (STAMPS - epoch)], axis=1)
    states = (np.mod(times * frequency + 0.03, 1.0) < duty).astype(float)
    return xr.DataArray(states, {"time": STAMPS, "view": ["left", "right"]}, ("time", "view"))


@pytest.mark.parametrize("offset", [0.00041, -0.0033, 0.0])
def test_a_diode_tells_offsets_to_a_part_of_a_frame(offset: float) -> None:
    """Ten frames a period: every switch falls on the same part of a frame."""
    clock = synchronise_by_diode(blinking(offset, 0.0), 100.0).sel(view="right")
    assert float(clock["offset_std"]) < 5e-4
    assert abs(float(clock["offset"]) - offset) < 3 * float(clock["offset_std"])
    assert clock["slack"] < 1e-9


def test_a_diode_that_drifts_through_the_frames_tells_more() -> None:
    """97 Hz is no multiple of the frame rate, so every switch falls on another part of a frame."""
    errors, stated = [], []
    for offset in np.linspace(-0.003, 0.003, 7):
        clock = synchronise_by_diode(blinking(offset, 0.0, frequency=97.0), 97.0, drift=1e-5).sel(view="right")
        errors.append(float(clock["offset"]) - offset)
        stated.append(float(clock["offset_std"]))
    assert np.sqrt(np.mean(np.square(errors))) < 1e-4
    assert 0.3 < np.sqrt(np.mean(np.square(errors)) / np.mean(np.square(stated))) < 2.0


def test_a_diode_that_cannot_be_seen_to_blink_is_refused() -> None:
    with pytest.raises(CrashkitError, match="left: expected frames less than 0.0005 s apart"):
        synchronise_by_diode(blinking(0.0, 0.0, frequency=1000.0), 1000.0)
    with pytest.raises(CrashkitError, match="expected a diode of the given frequency, found readings"):
        synchronise_by_diode(blinking(0.0, 0.0, frequency=100.0), 160.0)
    dark = blinking(0.0, 0.0) * 0.0
    with pytest.raises(CrashkitError, match="left: expected a reference that sees the diode switch, found none"):
        synchronise_by_diode(dark, 100.0)


def crash(offset: float, random: np.random.Generator) -> tuple[xr.Dataset, xr.Dataset]:
    """A film whose stamps are late, and an accelerometer, of a half-sine pulse of 40 ms from 14 m/s."""
    fine = np.arange(-200, 1000) * 1e-4
    pulse = np.where((fine > 0) & (fine < 0.04), -400.0 * np.sin(np.pi * fine / 0.04), 0.0)
    steps = np.diff(fine, prepend=fine[0] - 1e-4)
    velocity = 14.0 + np.cumsum(pulse * steps)
    position = np.cumsum(velocity * steps)
    stamps = np.arange(80) * 1e-3
    reading = np.interp(stamps - offset, fine, position)[:, None, None] + 1e-3 * random.standard_normal((80, 1, 1))
    film = xr.Dataset(
        {
            "position": (("time", "marker", "axis"), reading),
            "marker_body": ("marker", ["car"]),
            "position_std": ("marker", [1e-3]),
        },
        {"time": stamps, "marker": ["sill"], "axis": ["x"]},
    )
    felt = pulse[:, None, None] * 1.01 + 2.0 + 5.0 * random.standard_normal((len(fine), 1, 1))
    sensor = xr.Dataset(
        {"acceleration": (("time", "sensor", "axis"), felt), "sensor_body": ("sensor", ["car"])},
        {"time": fine, "sensor": ["tunnel"], "axis": ["x"]},
    )
    return film, sensor


def test_a_film_is_synchronised_with_an_accelerometer_that_has_gain_and_bias() -> None:
    deviations = []
    for seed in range(8):
        clock = synchronise_with_accelerometer(*crash(0.00213, np.random.default_rng(seed))).squeeze()
        assert abs(float(clock["offset"]) - 0.00213) < 1e-3
        deviations.append((float(clock["offset"]) - 0.00213) / float(clock["offset_std"]))
    assert 0.4 < np.sqrt(np.mean(np.square(deviations))) < 1.7


def test_corrected_stamps_are_the_times_at_which_the_film_was_taken() -> None:
    film, sensor = crash(0.002, np.random.default_rng(1))
    clock = synchronise_with_accelerometer(film, sensor)
    again = synchronised(film, clock)
    np.testing.assert_array_equal(again["position"], film["position"])
    assert abs(again["time"] - (film["time"].values - 0.002)).max() < 5e-4
    assert corrected_time(film["time"], clock).dims == ("time", "view")


def test_instruments_that_share_no_body_are_refused() -> None:
    film, sensor = crash(0.0, np.random.default_rng(1))
    other = sensor.assign(sensor_body=("sensor", ["sled"]))
    with pytest.raises(CrashkitError, match="film: expected markers on a body with an accelerometer, and an axis in common"):
        synchronise_with_accelerometer(film, other)
