"""What every Observer must do: subclass ObserverContract in a test module and give it three fixtures."""

import numpy as np
import pytest
import xarray as xr

from crashkit.protocols import Observer, ParameterSpec

STEP = 1e-3  # of a number whose size is not known


class ObserverContract:
    """The contract of an Observer.

    Subclasses give the fixtures
        observer: an instance.
        instrument: a recording group it understands, complete, from the motion's start to a little before its end.
        motion: of the bodies that the instrument watches, smooth, without sensitivities.

    Attributes:
        round_trip: how far a reconstruction from a prediction may be from the motion, of the motion's range.
        derivative: how far a derivative may be from a difference, of the largest derivative of its kind.
    """

    round_trip = 1e-3
    derivative = 1e-2

    def test_it_understands_the_instrument(self, observer: Observer, instrument: xr.Dataset) -> None:
        assert instrument.attrs["observer"] == observer.name
        assert observer.channel in instrument[observer.quantity].dims
        assert observer.quantity in [variable.name for variable in observer.schema.variables]

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
        shared = [name for name in reconstructed.data_vars if name in motion and "time" in reconstructed[name].dims]
        assert shared
        for name in shared:
            truth = motion[name].sel(body=reconstructed["body"]).interp(time=reconstructed["time"])
            span = float(truth.max() - truth.min())
            assert np.abs(reconstructed[name] - truth).max() <= self.round_trip * span

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
                np.testing.assert_array_equal(np.isnan(variable.isel(body=0, axis=0)), hidden)

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
                    channels = instrument[observer.channel].values
                    expected[:, channels != sensor] = 0.0
                assert np.abs(difference - expected)[1:-1].max() <= self.derivative * np.abs(expected).max() + 1e-9

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


def _directions(motion: xr.Dataset) -> dict[str, xr.Variable]:
    """Two smooth directions of change, x = 1 + t^2 and x = t^3, as sensitivities of all that a motion may hold."""
    time = motion["time"].values
    t = time / time[-1]
    powers = {
        "position": np.stack([1 + t**2, t**3], axis=-1),
        "velocity": np.stack([2 * t, 3 * t**2], axis=-1) / time[-1],
    }
    other = np.stack([np.ones_like(t), 6 * t], axis=-1)
    dims = ("time", "body", "axis")
    shape = [motion.sizes[dim] for dim in dims] + [2]
    directions = {"parameter": xr.Variable("parameter", ["square", "cube"])}
    for name in map(str, motion.data_vars):
        if motion[name].dims == dims:
            columns = powers.get(name, other)[:, None, None, :]
            directions[f"{name}_sensitivity"] = xr.Variable((*dims, "parameter"), np.broadcast_to(columns, shape).copy())
    return directions


def _moved(motion: xr.Dataset, directions: dict[str, xr.Variable], parameter: int, step: float) -> xr.Dataset:
    moved = {}
    for name in motion.data_vars:
        if f"{name}_sensitivity" in directions:
            moved[name] = motion[name] + step * directions[f"{name}_sensitivity"].isel(parameter=parameter)
    return motion.assign(moved)
