"""What every Observer must do: subclass ObserverContract in a test module and give it three fixtures."""

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from crashkit.data.channel_filter import frequency_class
from crashkit.protocols import Observer, ParameterSpec

STEP = 1e-4  # of a number whose size is not known
EXACT = 1e-9  # m, rad and so on, an error that is none
SPACE = ("time", "body", "axis")


class ObserverContract:
    """The contract of an Observer.

    Subclasses give the fixtures
        observer: an instance.
        instrument: a recording group it understands, complete, from the motion's start to a little before its end.
        motion: of the bodies that the instrument watches, smooth, without sensitivities; in a line, a plane or space.

    An instrument that works in all of these is tested in each by a subclass, or by fixtures with `params`. Where the
    instrument states its noise (`<quantity>_std`), the standard deviations of what it reconstructs are put to the test.

    Attributes:
        round_trip: how far a reconstruction from a prediction may be from the motion, of the motion's range; an orientation,
            in rad.
        derivative: how far a derivative may be from a difference, of the largest derivative of its kind.
        draws: how often noise is drawn to test the stated standard deviations.
        coverage: by which factor the errors may be larger or smaller than these, in their root mean square.
    """

    round_trip = 1e-3
    derivative = 1e-2
    draws = 20
    coverage = 1.2

    def test_it_understands_the_instrument(self, observer: Observer, instrument: xr.Dataset) -> None:
        assert instrument.attrs["observer"] == observer.name
        assert observer.channel in instrument[observer.quantity].dims
        assert observer.quantity in [variable.name for variable in observer.schema.variables]

    def test_standard_deviations_are_above_0(self, observer: Observer) -> None:
        name = f"{observer.quantity}_std"
        loose = [variable for variable in observer.schema.variables if variable.name == name and not variable.positive]
        assert not loose, f"{name}: expected it declared with positive=True, as crashkit.data.schemas.std_of does"

    def test_errors_are_declared_with_their_null(self, observer: Observer) -> None:
        names = [spec.name for spec in observer.errors]
        assert len(set(names)) == len(names)
        assert set(observer.instrument_errors) <= set(names)
        for spec in observer.errors:
            assert spec.lower <= _null(spec) <= spec.upper

    def test_a_prediction_has_the_form_of_the_recording(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset
    ) -> None:
        predicted = observer.predict(motion, instrument)
        recorded = instrument[observer.quantity]
        assert predicted[observer.quantity].dims == recorded.dims
        assert predicted[observer.quantity].shape == recorded.shape
        assert np.isfinite(predicted[observer.quantity]).all()
        errors = predicted[f"{observer.quantity}_error_sensitivity"]
        assert errors.dims == (*recorded.dims, "error")
        assert errors["error"].values.tolist() == [spec.name for spec in observer.errors]

    def test_a_prediction_does_not_depend_on_what_was_recorded(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset
    ) -> None:
        blank = instrument.assign({observer.quantity: instrument[observer.quantity] * np.nan})
        assert_same(observer, observer.predict(motion, blank), observer.predict(motion, instrument))

    def test_times_after_the_motion_are_unknown(self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset) -> None:
        cut = motion.isel(time=slice(None, motion.sizes["time"] // 2))
        predicted = observer.predict(cut, instrument)[observer.quantity]
        unknown = instrument["time"].values > cut["time"].values[-1]
        assert unknown.any()
        assert np.isnan(predicted.isel(time=unknown)).all()
        assert np.isfinite(predicted.isel(time=~unknown)).all()

    def test_reconstruction_of_a_prediction_is_the_motion(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset
    ) -> None:
        reconstructed = observer.reconstruct(_recorded(observer, instrument, motion))
        shared = _shared(reconstructed, motion)
        assert shared
        for name in shared:
            error = _error(name, reconstructed, motion)
            assert np.isfinite(error).all()
            span = 1.0 if name == "orientation" else float(motion[name].max() - motion[name].min())
            assert np.abs(error).max() <= self.round_trip * span

    def test_a_missing_sample_stays_missing(self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset) -> None:
        allowed = {variable.name: variable.allow_nan for variable in observer.schema.variables}
        if not allowed[observer.quantity]:
            pytest.skip(f"{observer.name} does not allow missing samples")
        recording = _recorded(observer, instrument, motion)
        gap = recording.sizes["time"] // 2
        hidden = np.arange(recording.sizes["time"]) == gap
        recording[observer.quantity] = recording[observer.quantity].where(xr.DataArray(~hidden, dims="time"))
        for variable in observer.reconstruct(recording).data_vars.values():
            if "time" in variable.dims:
                missing = np.isnan(variable.transpose("time", ...).values).reshape(len(hidden), -1)
                np.testing.assert_array_equal(missing, np.broadcast_to(hidden[:, None], missing.shape))

    def test_stated_standard_deviations_are_those_of_the_errors(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset
    ) -> None:
        if f"{observer.quantity}_std" not in instrument or frequency_class(instrument):
            pytest.skip("white noise of known size is needed")
        exact = _recorded(observer, instrument, motion)
        random = np.random.default_rng(1)
        draws = [observer.reconstruct(_noisy(observer, exact, random)) for _ in range(self.draws)]
        stated = [name for name in _shared(draws[0], motion) if f"{name}_std" in draws[0]]
        if not stated:
            pytest.skip(f"{observer.name} states no standard deviations")
        for name in stated:
            square = np.mean([_relative_square(name, draw, motion) for draw in draws])
            assert 1.0 / self.coverage <= np.sqrt(square) <= self.coverage

    def test_errors_at_their_null_change_nothing(self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset) -> None:
        null = {spec.name: _null(spec) for spec in observer.errors}
        assert_same(observer, observer.predict(motion, instrument, {"": null}), observer.predict(motion, instrument))

    def test_error_sensitivities_agree_with_differences(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset
    ) -> None:
        sensitivities = observer.predict(motion, instrument)[f"{observer.quantity}_error_sensitivity"]
        for spec in observer.errors:
            for sensor in self._places(observer, instrument, spec):
                difference = _error_difference(observer, instrument, motion, sensor, spec)
                expected = sensitivities.isel(error=[s.name for s in observer.errors].index(spec.name)).values.copy()
                if sensor:
                    others = instrument[observer.channel].values != sensor
                    expected[_along(sensitivities.dims.index(observer.channel), others)] = 0.0
                assert np.abs(difference - expected)[1:-1].max() <= self.derivative * np.abs(expected).max() + 1e-9

    def test_errors_of_all_axes_together_are_those_of_the_channel(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset
    ) -> None:
        axis = str(instrument[observer.quantity].dims[-1])
        if axis not in instrument.coords:
            pytest.skip(f"the {axis} has no labels")
        own = {spec.name: _wrong(spec) for spec in observer.errors if spec.name not in observer.instrument_errors}
        channel = str(instrument[observer.channel].values[0])
        by_axis = {f"{channel}/{label}": own for label in instrument[axis].values}
        together = observer.predict(motion, instrument, {channel: own})
        assert_same(observer, observer.predict(motion, instrument, by_axis), together)

    @pytest.mark.parametrize("perfect", [True, False])
    def test_sensitivities_agree_with_differences(
        self, observer: Observer, instrument: xr.Dataset, motion: xr.Dataset, perfect: bool
    ) -> None:
        errors = {} if perfect else {"": {spec.name: _wrong(spec) for spec in observer.errors}}
        directions = _directions(motion)
        sensitivity = observer.predict(motion.assign(directions), instrument, errors)[f"{observer.quantity}_sensitivity"]
        assert sensitivity.dims == (*instrument[observer.quantity].dims, "parameter")
        assert np.abs(sensitivity).max() > 0.0
        for parameter in range(sensitivity.sizes["parameter"]):
            ahead, behind = (
                observer.predict(_moved(motion, directions, parameter, step), instrument, errors)[observer.quantity].values
                for step in (STEP, -STEP)
            )
            expected = sensitivity.isel(parameter=parameter).values
            assert np.abs((ahead - behind) / (2 * STEP) - expected).max() <= 1e-6 * np.abs(expected).max()

    @staticmethod
    def _places(observer: Observer, instrument: xr.Dataset, spec: ParameterSpec) -> list[str]:
        """Where this error can be set: the whole instrument, or each of its channels."""
        return [""] if spec.name in observer.instrument_errors else instrument[observer.channel].values.tolist()


def assert_same(observer: Observer, one: xr.Dataset, other: xr.Dataset) -> None:
    """Two predictions agree to the last digit."""
    np.testing.assert_array_equal(one[observer.quantity].values, other[observer.quantity].values)


def _null(spec: ParameterSpec) -> float:
    assert spec.null is not None, f"{spec.name} must declare the null at which the instrument is perfect"
    return spec.null


def _wrong(spec: ParameterSpec) -> float:
    """A value of the error that is well off its null."""
    return _null(spec) + 0.1 * (spec.upper - _null(spec) if np.isfinite(spec.upper) else 1.0)


def _recorded(observer: Observer, instrument: xr.Dataset, motion: xr.Dataset) -> xr.Dataset:
    predicted = observer.predict(motion, instrument)[observer.quantity]
    return instrument.assign({observer.quantity: (predicted.dims, predicted.values, instrument[observer.quantity].attrs)})


def _error_difference(
    observer: Observer, instrument: xr.Dataset, motion: xr.Dataset, sensor: str, spec: ParameterSpec
) -> np.ndarray:
    step = 1e-5 * (spec.upper - spec.lower) if np.isfinite(spec.upper - spec.lower) else STEP
    ahead, behind = (
        observer.predict(motion, instrument, {sensor: {spec.name: _null(spec) + change}})[observer.quantity].values
        for change in (step, -step)
    )
    return (ahead - behind) / (2 * step)


def _along(position: int, chosen: np.ndarray) -> tuple[slice | np.ndarray, ...]:
    return (*(slice(None),) * position, chosen)


def _noisy(observer: Observer, exact: xr.Dataset, random: np.random.Generator) -> xr.Dataset:
    """The recording with noise of the size that it states."""
    recorded = exact[observer.quantity]
    noise = exact[f"{observer.quantity}_std"] * xr.DataArray(random.standard_normal(recorded.shape), dims=recorded.dims)
    return exact.assign({observer.quantity: (recorded + noise).transpose(*recorded.dims).assign_attrs(recorded.attrs)})


def _shared(reconstructed: xr.Dataset, motion: xr.Dataset) -> list[str]:
    """What a reconstruction and a motion both hold, time by time."""
    return [str(name) for name in reconstructed.data_vars if name in motion and "time" in reconstructed[name].dims]


def _error(name: str, reconstructed: xr.Dataset, motion: xr.Dataset) -> np.ndarray:
    """Reconstructed less true, at the reconstruction's times, (time, body, axis); of an orientation, the rotation vector."""
    found = reconstructed[name].transpose("time", "body", ...)
    true = motion[name].sel(body=reconstructed["body"]).interp(time=reconstructed["time"]).transpose(*found.dims)
    if name != "orientation":
        return np.asarray((found - true).values)
    flat = [Rotation.from_quat(one.values.reshape(-1, 4), scalar_first=True) for one in (found, true)]
    return np.asarray((flat[0] * flat[1].inv()).as_rotvec().reshape(*found.shape[:2], 3))


def _relative_square(name: str, reconstructed: xr.Dataset, motion: xr.Dataset) -> float:
    """The mean square of the error over its stated standard deviation; one number for all axes means their root of squares.

    What is stated to be exact, as a state of rest at the start, must be so and is left out of the mean.
    """
    error = _error(name, reconstructed, motion)
    std = reconstructed[f"{name}_std"].transpose("time", "body", ...).values
    if std.ndim < error.ndim:
        error = np.linalg.norm(error, axis=-1)
    uncertain = np.broadcast_to(std > 0.0, error.shape)
    assert np.abs(error[~uncertain]).max(initial=0.0) <= EXACT, f"{name} is stated to be exact"
    return float(np.mean((error[uncertain] / np.broadcast_to(std, error.shape)[uncertain]) ** 2))


def _directions(motion: xr.Dataset) -> dict[str, xr.Variable]:
    """Two smooth directions of change, x = 1 + t^2 and x = t^3, as sensitivities of all that a motion may hold."""
    time = motion["time"].values
    t = time / time[-1]
    powers = {
        "position": np.stack([1 + t**2, t**3], axis=-1),
        "velocity": np.stack([2 * t, 3 * t**2], axis=-1) / time[-1],
    }
    other = np.stack([np.ones_like(t), 6 * t], axis=-1)
    shape = [motion.sizes[dim] for dim in SPACE] + [2]
    names = [str(name) for name in motion.data_vars if motion[name].dims == SPACE]
    names += ["rotation"] if "orientation" in motion else []
    directions = {"parameter": xr.Variable("parameter", ["square", "cube"])}
    for name in names:
        columns = powers.get(name, other)[:, None, None, :]
        directions[f"{name}_sensitivity"] = xr.Variable((*SPACE, "parameter"), np.broadcast_to(columns, shape).copy())
    return directions


def _moved(motion: xr.Dataset, directions: dict[str, xr.Variable], parameter: int, step: float) -> xr.Dataset:
    moved = {}
    for name in motion.data_vars:
        if f"{name}_sensitivity" in directions:
            moved[name] = motion[name] + step * directions[f"{name}_sensitivity"].isel(parameter=parameter)
    if "orientation" in motion:
        turn = step * directions["rotation_sensitivity"].isel(parameter=parameter).values
        before = Rotation.from_quat(motion["orientation"].values.reshape(-1, 4), scalar_first=True)
        after = Rotation.from_rotvec(turn.reshape(-1, 3)) * before
        shape = motion["orientation"].shape
        moved["orientation"] = motion["orientation"].copy(data=after.as_quat(scalar_first=True).reshape(shape))
    return motion.assign(moved)
