from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from attrs import evolve
from scipy.spatial.transform import Rotation

from crashkit.data.validate import faults_of
from crashkit.errors import CrashkitError
from crashkit.testing.observer_contract import ObserverContract
from crashkit_cameras import Camera, Film, calibrate, film_group, make_laboratory, triangulate

FRAMES = np.linspace(0.0, 0.09, 10)
NODES = np.linspace(0.0, 0.1, 1001)
MARKERS = {
    "sill": ("car", (0.5, 0.4, -0.2)),
    "roof": ("car", (-0.3, 0.1, 0.5)),
    "boot": ("car", (-0.6, -0.3, 0.0)),
    "door": ("car", (0.0, 0.5, 0.1)),
}


def stated(group: xr.Dataset, std: float = 0.3) -> xr.Dataset:
    """The group with the noise of its markers stated."""
    return group.assign(image_position_std=("marker", np.full(group.sizes["marker"], std), {"units": "pixel"}))


class TestCameraContract(ObserverContract):
    draws = 5

    @pytest.fixture
    def observer(self) -> Camera:
        return Camera()

    @pytest.fixture(params=["plane", "space"])
    def motion(self, request: pytest.FixtureRequest) -> xr.Dataset:
        motion: xr.Dataset = request.getfixturevalue(request.param)(NODES)
        return motion

    @pytest.fixture
    def instrument(self, motion: xr.Dataset) -> xr.Dataset:
        return stated(make_laboratory(2, 20, seed=1).record(motion, MARKERS, FRAMES))


class TestCameraInALineContract(ObserverContract):
    """Cameras find the places of bodies in space, whichever axes their model has."""

    @pytest.fixture
    def observer(self) -> Camera:
        return Camera()

    @pytest.fixture
    def motion(self, line: Callable[[np.ndarray], xr.Dataset]) -> xr.Dataset:
        return line(NODES)

    @pytest.fixture
    def instrument(self, motion: xr.Dataset) -> xr.Dataset:
        return make_laboratory(2, 20, seed=1).record(motion, MARKERS, FRAMES)


def test_in_a_line_stated_standard_deviations_are_those_of_the_errors(line) -> None:
    exact, random = stated(make_laboratory(2, 20, seed=1).record(line(NODES), MARKERS, FRAMES)), np.random.default_rng(3)
    deviations = []
    for _ in range(5):
        noise = 0.3 * random.standard_normal(exact["image_position"].shape)
        found = Camera().reconstruct(exact.assign(image_position=exact["image_position"] + noise)).sel(axis="x")
        deviations.append((found["position"] - line(FRAMES)["position"].sel(axis="x")) / found["position_std"])
    assert 0.8 < np.sqrt(np.mean(np.square(deviations))) < 1.2


def test_a_camera_group_is_described_and_what_is_missing_is_named(space) -> None:
    group = stated(make_laboratory().record(space(NODES), MARKERS, FRAMES))
    assert faults_of(group, Camera.schema) == []
    faults = [str(fault) for fault in faults_of(group.drop_vars(["control_image", "control_position"]), Camera.schema)]
    assert len(faults) == 2
    assert "control_position" in faults[0]
    assert "control_image" in faults[1]


def test_a_survey_may_be_exact_and_no_standard_deviation_is_below_0(space) -> None:
    group = stated(make_laboratory().record(space(NODES), MARKERS, FRAMES))
    exact = group.assign(control_position_std=("control_point", np.zeros(group.sizes["control_point"]), {"units": "m"}))
    assert faults_of(exact, Camera.schema) == []
    exact["control_position_std"][2] = -1e-3
    exact["image_position_std"][0] = 0.0
    assert [str(fault).partition("found ")[0] for fault in faults_of(exact, Camera.schema)] == [
        "camera/image_position_std: expected values above 0, ",
        "camera/control_position_std: expected values of at least 0, ",
    ]


def test_without_noise_the_prediction_is_what_the_true_cameras_see(any_motion) -> None:
    group = make_laboratory(3, 30, seed=2).record(any_motion(NODES), MARKERS, FRAMES)
    predicted = Camera().predict(any_motion(NODES), group)
    np.testing.assert_allclose(predicted["image_position"], group["image_position"], atol=0.01)


def test_in_space_the_car_is_found_with_its_turning(space) -> None:
    truth = space(FRAMES).sel(body=["car"])
    group = make_laboratory(2, 20, seed=1).record(space(NODES), MARKERS, FRAMES, np.random.default_rng(0))
    found = Camera().reconstruct(group)
    assert found.attrs["unknown"] == ""
    assert np.abs(found["position"] - truth["position"]).max() < 6e-3
    turn = Rotation.from_quat(found["orientation"].values[:, 0], scalar_first=True)
    true = Rotation.from_quat(truth["orientation"].values[:, 0], scalar_first=True)
    assert (turn * true.inv()).magnitude().max() < 0.02


def test_one_marker_tells_the_place_of_a_body_that_does_not_turn(any_motion) -> None:
    motion = any_motion(NODES)
    group = make_laboratory(2, 20, seed=1).record(motion, {"hub": ("car", (0.0, 0.0, 0.0))}, FRAMES)
    found = Camera().reconstruct(group)
    assert found.attrs["unknown"] == "car: its turning (three markers that are not on one line would tell it)"
    assert "orientation" not in found
    np.testing.assert_allclose(found["position"].sel(axis="x", body="car"), any_motion(FRAMES)["position"][:, 1, 0], atol=1e-4)


def test_a_marker_hidden_from_a_view_is_found_by_the_others(space) -> None:
    group = make_laboratory(3, 20, seed=1).record(space(NODES), MARKERS, FRAMES)
    whole = triangulate(group)["position"]
    group["image_position"][4, 1, 2] = np.nan
    group["image_position"][5, :2, 2] = np.nan
    found = triangulate(group)["position"]
    missing = np.isnan(found.values[..., 0])
    assert np.argwhere(missing).tolist() == [[5, 2]]
    assert np.abs(found - whole).max() < 1e-4


def test_a_film_group_tells_the_same_as_its_cameras(space) -> None:
    group = make_laboratory(2, 40, seed=3).record(space(NODES), MARKERS, FRAMES, np.random.default_rng(1))
    film = film_group(group, triangulate(group))
    assert faults_of(film, Film.schema) == []
    difference = Film().reconstruct(film)["position"] - Camera().reconstruct(group)["position"]
    assert np.abs(difference).max() < 2e-3


def test_one_view_is_not_enough(space) -> None:
    group = make_laboratory(1, 20).record(space(NODES), MARKERS, FRAMES)
    assert np.isfinite(Camera().predict(space(NODES), group)["image_position"]).all()
    with pytest.raises(CrashkitError, match="expected two views or more, as one does not tell how far away a marker is"):
        Camera().reconstruct(group)


def test_a_bias_can_be_that_of_one_image_axis(space) -> None:
    group = make_laboratory(2, 20).record(space(NODES), MARKERS, FRAMES)
    true = Camera().predict(space(NODES), group)["image_position"]
    off = Camera().predict(space(NODES), group, {"roof/v": {"bias": 2.0}})["image_position"]
    expected = np.zeros_like(true.values)
    expected[:, :, 1, 1] = 2.0
    np.testing.assert_allclose(off - true, expected, atol=1e-9)


def test_a_late_clock_that_gets_later_shows_the_motion_as_it_was(space) -> None:
    group = make_laboratory(2, 20).record(space(NODES), MARKERS, FRAMES[1:])
    late = Camera().predict(space(NODES), group, {"": {"clock_offset": 0.004, "clock_rate": 0.01}})["image_position"]
    true = Camera().predict(space(NODES), group.assign_coords(time=0.99 * group["time"] - 0.004))["image_position"]
    np.testing.assert_allclose(late.values, true.values)


def test_a_quantity_that_the_motion_lacks_is_named(space) -> None:
    group = make_laboratory().record(space(NODES), MARKERS, FRAMES)
    with pytest.raises(CrashkitError, match="camera: expected a motion with angular_velocity, found none"):
        Camera().predict(space(NODES).drop_vars("angular_velocity"), group)
    with pytest.raises(CrashkitError, match=r"camera: expected a body of the motion \(barrier\), found car"):
        Camera().predict(space(NODES).sel(body=["barrier"]), group)


def test_a_marker_outside_the_volume_of_the_control_points_is_flagged() -> None:
    lab = make_laboratory(2, 30, seed=1)
    positions = np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 1.5]]])
    assert triangulate(lab.record_points(positions, np.zeros(1)))["extrapolated"].values.tolist() == [[False, True]]


def test_stated_errors_are_real_whatever_the_laboratory() -> None:
    """The mean square of error over stated standard deviation, over laboratories, their noise and points."""
    squares = []
    for seed in range(12):
        lab, random = make_laboratory(2, 12, seed), np.random.default_rng([seed, 7])
        truth = random.uniform(-0.9, 0.9, (1, 60, 3))
        found = triangulate(lab.record_points(truth, np.zeros(1), random))
        squares.append((((found["position"] - truth) / found["position_std"]) ** 2).values.mean())
    assert 0.7 < np.mean(squares) < 1.4


def test_a_view_that_sees_worse_counts_for_less() -> None:
    lab, random = make_laboratory(3, 40, seed=4), np.random.default_rng(5)
    truth = random.uniform(-0.8, 0.8, (1, 80, 3))
    group = lab.record_points(truth, np.zeros(1), random)
    blur = 3.0 * random.standard_normal((80, 2)), 3.0 * random.standard_normal((40, 2))
    group["image_position"][0, 2] += blur[0]
    group["control_image"][:, 2] += blur[1]
    three = triangulate(group)["position"] - truth
    two = triangulate(group.isel(view=[0, 1]))["position"] - truth
    assert float((three**2).mean()) < 1.05 * float((two**2).mean())
    assert calibrate(group).control_std[2] > 5.0 * calibrate(group).control_std[0]


def test_a_laboratory_with_less_noise_finds_more(space) -> None:
    truth = space(FRAMES)["position"].sel(body=["car"])
    errors = []
    for noise in (0.5, 0.05):
        lab = evolve(make_laboratory(2, 20, seed=6), noise=noise)
        group = lab.record(space(NODES), MARKERS, FRAMES, np.random.default_rng(2))
        errors.append(float(np.abs(Camera().reconstruct(group)["position"] - truth).max()))
    assert errors[1] < 0.2 * errors[0]
