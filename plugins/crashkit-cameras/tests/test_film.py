import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.testing.observer_contract import ObserverContract
from crashkit_cameras import Film

POINTS = {"bumper": -0.4, "sill": 0.3, "boot": 1.1}
BODIES = ["engine", "car", "car"]


def film_at(times: np.ndarray) -> xr.Dataset:
    markers = list(POINTS)
    return xr.Dataset(
        {
            "position": (("time", "marker", "axis"), np.zeros((len(times), 3, 1)), {"units": "m"}),
            "marker_body": ("marker", BODIES),
            "marker_point": (("marker", "axis"), np.array(list(POINTS.values()))[:, None], {"units": "m"}),
            "position_std": ("marker", [1e-3, 1e-3, 2e-3], {"units": "m"}),
        },
        {"time": times, "marker": markers, "axis": ["x"]},
        {"observer": "film"},
    )


def motion_at(times: np.ndarray) -> xr.Dataset:
    """A wall, an engine on the cubic -1 + 10 t - 400 t^3, a car on the sine -2 + 0.5 sin(25 t)."""
    dims = ("time", "body", "axis")
    zero = np.zeros_like(times)
    position = np.stack([zero, -1 + 10 * times - 400 * times**3, -2 + 0.5 * np.sin(25 * times)], axis=1)
    velocity = np.stack([zero, 10 - 1200 * times**2, 12.5 * np.cos(25 * times)], axis=1)
    return xr.Dataset(
        {"position": (dims, position[..., None]), "velocity": (dims, velocity[..., None])},
        {"time": times, "body": ["wall", "engine", "car"], "axis": ["x"]},
    )


class TestFilmContract(ObserverContract):
    @pytest.fixture
    def observer(self) -> Film:
        return Film()

    @pytest.fixture
    def instrument(self) -> xr.Dataset:
        return film_at(np.arange(91) * 1e-3)

    @pytest.fixture
    def motion(self) -> xr.Dataset:
        return motion_at(np.arange(1001) * 1e-4)


def test_markers_move_with_their_bodies_from_their_points() -> None:
    times = np.array([0.0, 0.02, 0.05])
    predicted = Film().predict(motion_at(times), film_at(times))["position"].values[:, :, 0]
    car = -2 + 0.5 * np.sin(25 * times)
    np.testing.assert_allclose(predicted, np.stack([-1 + 10 * times - 400 * times**3 - 0.4, car + 0.3, car + 1.1], axis=1))


def test_between_nodes_a_cubic_motion_is_exact() -> None:
    times = np.array([0.0, 0.013, 0.0137, 0.041, 0.0999])
    predicted = Film().predict(motion_at(np.array([0.0, 0.01, 0.05, 0.1])), film_at(times))["position"]
    np.testing.assert_allclose(predicted[:, 0, 0], -1.4 + 10 * times - 400 * times**3, rtol=0, atol=1e-14)


def test_before_contact_the_motion_is_uniform() -> None:
    predicted = Film().predict(motion_at(np.linspace(0, 0.1, 101)), film_at(np.array([-0.02, -0.01, 0.0])))["position"]
    np.testing.assert_allclose(predicted[:, 0, 0], [-1.6, -1.5, -1.4])


def test_a_late_clock_that_gets_later_shows_the_motion_as_it_was() -> None:
    motion, film = motion_at(np.linspace(0, 0.1, 1001)), film_at(np.array([0.03, 0.06]))
    late = Film().predict(motion, film, {"": {"clock_offset": 0.002, "clock_rate": 0.01}})["position"]
    true = Film().predict(motion, film_at(np.array([0.0277, 0.0574])))["position"]
    np.testing.assert_allclose(late.values, true.values)


def test_gain_scales_the_displacement_and_bias_shifts_it() -> None:
    motion, film = motion_at(np.linspace(0, 0.1, 1001)), film_at(np.array([0.0, 0.06]))
    true = Film().predict(motion, film)["position"].values
    off = Film().predict(motion, film, {"sill": {"gain": 1.1, "bias": 0.01}})["position"].values
    np.testing.assert_allclose(off[:, 1], true[0, 1] + 1.1 * (true[:, 1] - true[0, 1]) + 0.01)
    np.testing.assert_array_equal(off[:, [0, 2]], true[:, [0, 2]])


def test_a_body_is_seen_while_one_of_its_markers_is() -> None:
    times = np.linspace(0, 0.1, 11)
    motion, film = motion_at(times), film_at(times)
    film["position"] = (film["position"].dims, Film().predict(motion, film)["position"].values)
    film["position"][3, 1] = np.nan
    film["position"][5, 1:] = np.nan
    car = Film().reconstruct(film)["position"].sel(body="car", axis="x").values
    np.testing.assert_array_equal(np.isnan(car), np.arange(11) == 5)
    np.testing.assert_allclose(np.delete(car, 5), np.delete(-2 + 0.5 * np.sin(25 * times), 5))


def test_markers_count_by_their_noise_and_two_tell_more_than_one() -> None:
    """The mean weighted by 1 / variance: 1 / std² = 1 / 1 mm² + 1 / 2 mm²."""
    found = Film().reconstruct(film_at(np.linspace(0, 0.1, 11)))
    std = found["position_std"].sel(axis="x")
    np.testing.assert_allclose(std.sel(body="engine"), 1e-3)
    np.testing.assert_allclose(std.sel(body="car"), (1e-3**-2 + 2e-3**-2) ** -0.5)
    film = film_at(np.linspace(0, 0.1, 11))
    film["position"][:, 1] += 1e-3
    shift = (Film().reconstruct(film)["position"] - found["position"]).sel(axis="x", body="car")
    np.testing.assert_allclose(shift, 0.8e-3)


def test_a_body_that_the_motion_lacks_is_named() -> None:
    film = film_at(np.array([0.0, 0.1]))
    film["marker_body"] = ("marker", ["engine", "trailer", "car"])
    with pytest.raises(CrashkitError, match=r"film: expected a body of the motion \(wall, engine, car\), found trailer"):
        Film().predict(motion_at(np.array([0.0, 0.1])), film)


@pytest.mark.parametrize("errors", [{"sill": {"clock_offset": 1e-3}}, {"sill": {"drift": 1.0}}, {"": {"drift": 1.0}}])
def test_an_error_that_is_not_declared_there_is_refused(errors: dict[str, dict[str, float]]) -> None:
    times = np.array([0.0, 0.1])
    with pytest.raises(CrashkitError, match="expected an error of"):
        Film().predict(motion_at(times), film_at(times), errors)


def test_errors_of_a_marker_that_this_run_lacks_are_passed_over() -> None:
    times = np.array([0.0, 0.1])
    motion, film = motion_at(times), film_at(times)
    with_error = Film().predict(motion, film, {"roof": {"gain": 2.0}})
    np.testing.assert_array_equal(with_error["position"], Film().predict(motion, film)["position"])
