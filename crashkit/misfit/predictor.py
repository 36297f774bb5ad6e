"""What a model predicts that the instruments of some recordings would read."""

from collections.abc import Mapping, Sequence
from functools import cached_property, partial

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.mechanics import Simulator
from crashkit.mechanics.kernel.arrays import Floats, Integers, Record
from crashkit.mechanics.repeated_run import RepeatedRun
from crashkit.misfit.channel import Channel, Group
from crashkit.misfit.observed import predicted_by, values_of
from crashkit.misfit.readout import Readout, instants_of, knows_what_is_shown, readout_of
from crashkit.misfit.turning_readout import TurningReadout
from crashkit.model import Model
from crashkit.protocols import SensorErrors

STEP = 5e-4
"""s, longest step of the integration: a twentieth of the period of a mass of 100 kg on a spring of 4 MN/m."""
SAME_INSTANT = 1e-9
"""s; time stamps closer than this are one instant written by two instruments."""


@frozen
class Prediction:
    """The predicted samples of one group as (time, column), and their derivatives as (time, column, parameter)."""

    samples: np.ndarray
    sensitivity: np.ndarray | None


class Predictor:
    """Simulates a model in the conditions of each run and lets each instrument observe it."""

    def __init__(
        self,
        model: Model,
        recordings: Mapping[str, xr.DataTree],
        groups: Sequence[Group],
        simulator: Simulator,
        step: float = STEP,
    ) -> None:
        self.model = model
        self.step = step
        self.simulator = simulator
        self.groups = tuple(groups)
        self.names = tuple(model.free_parameters())
        self._structural = tuple(name for name in self.names if not name.startswith("instrument."))
        self._columns = [self.names.index(name) for name in self._structural]
        self._fixed = _moved(model, simulator.model)
        self._initial = {run: initial_state(recording, model) for run, recording in recordings.items()}
        stamps = {run: [instants_of(group) for group in self.groups if group.run == run] for run in recordings}
        self._times = {run: _instants(times, _clock_margin(model, times)) for run, times in stamps.items()}

    @property
    def usual_gap(self) -> float:
        """s, the usual time between two instants that something is read at, in the run where that is least."""
        return min((float(np.median(np.diff(times))) for times in self._times.values() if len(times) > 1), default=self.step)

    @property
    def longest_step(self) -> float:
        """s, the longest time between two instants at which steps end; none is longer, whatever is asked for."""
        return max((float(np.max(np.diff(run.stops, prepend=0.0))) for run in self._runs.values()), default=self.step)

    def motion(self, run: str, values: Mapping[str, float], sensitivities: bool = False) -> xr.Dataset:
        """The simulated motion of one run at every instant that one of its instruments reads."""
        wanted = self._structural if sensitivities else ()
        values = {**self._fixed, **values}
        return self.simulator.motion(self._times[run], values, self._initial[run], wanted, self.step)

    def predict(self, values: Mapping[str, float], sensitivities: bool = False) -> list[Prediction]:
        """The predictions for every group, in order; `values` by parameter path."""
        return self.predict_at(np.array([values[name] for name in self.names], dtype=float), sensitivities)

    def predict_at(self, values: Floats, sensitivities: bool = False) -> list[Prediction]:
        """The same for values in the order of `names`; the predictions of all groups are arrays of their own."""
        told: dict[int, Prediction] = {}
        for run, repeated in self._runs.items():
            record = repeated.record(values[self._columns], sensitivities)
            told |= self._predict_run(run, repeated, record, values, sensitivities)
        return [told[number] for number in range(len(self.groups))]

    def _predict_run(
        self, run: str, repeated: RepeatedRun, record: Record, values: Floats, sensitivities: bool
    ) -> dict[int, Prediction]:
        """By number of the group."""
        motion, told = None, {}
        for number, (group, readout) in enumerate(zip(self.groups, self._readouts, strict=True)):
            if group.run != run:
                continue
            if readout is None:
                motion = repeated.motion(record) if motion is None else motion
                told[number] = self._observe(group, motion, values, sensitivities)
            elif group.name in self._wrong:
                told[number] = self._misread(group, readout, record, values, sensitivities)
            else:
                told[number] = self._read(readout, record, sensitivities)
        return told

    @cached_property
    def _runs(self) -> dict[str, RepeatedRun]:
        """Of the runs that something reads. Made for the first prediction: many models are never asked for one."""
        return {
            run: RepeatedRun(
                self.simulator, self._times[run], self._structural, self._fixed, self._initial[run], self.step,
                self._steps_end_at_all, wanted,
            )
            for run, wanted in self._wanted.items()
        }  # fmt: skip

    @property
    def _steps_end_at_all(self) -> bool:
        """Whether steps end at every instant: only there the orientations of bodies in space are known."""
        return len(self.model.axes) == 3 and None in self._full_readouts

    @cached_property
    def _readouts(self) -> list[Readout | TurningReadout | None]:
        """What is read without a Dataset, of a record that holds no more than is wanted."""
        wanted = [self._wanted[group.run] for group in self.groups]
        pairs = zip(self._full_readouts, wanted, strict=True)
        return [readout if readout is None or of is None else readout.within(of) for readout, of in pairs]

    @cached_property
    def _wanted(self) -> dict[str, Integers | None]:
        """The entries of each run's record that something reads; None where a Dataset takes all."""
        runs = [group.run for group in self.groups]
        return {run: _read_of([r for r, own in zip(self._full_readouts, runs, strict=True) if own == run]) for run in runs}

    @cached_property
    def _full_readouts(self) -> list[Readout | TurningReadout | None]:
        """What is read without a Dataset, of a record of all entries."""
        axes = set(self.model.axes)
        return [
            readout_of(group, self.simulator, self._times[group.run], len(axes) > 1, SAME_INSTANT, group.name in self._wrong)
            if knows_what_is_shown(group, self._wrong.get(group.name, ()), axes)
            else None
            for group in self.groups
        ]

    @cached_property
    def _wrong(self) -> dict[str, list[str]]:
        """The errors that the model gives each instrument that has any."""
        wrong: dict[str, list[str]] = {}
        for entry in self.model.instruments:
            wrong[entry.instrument] = sorted({*wrong.get(entry.instrument, []), *entry.parameters})
        return wrong

    def _read(self, readout: Readout | TurningReadout, record: Record, sensitivities: bool) -> Prediction:
        samples = readout.samples(record)
        if not sensitivities:
            return Prediction(samples, None)
        if len(self._columns) == len(self.names):
            return Prediction(samples, readout.sensitivity(record))
        table = np.zeros((*samples.shape, len(self.names)))
        if self._columns:
            table[:, :, self._columns] = readout.sensitivity(record)
        return Prediction(samples, table)

    def _misread(
        self, group: Group, readout: Readout | TurningReadout, record: Record, values: Floats, sensitivities: bool
    ) -> Prediction:
        wanted = self._wrong[group.name] if sensitivities else []
        read = readout.misread(record, self._errors(group, values), wanted, sensitivities)
        samples = read.value.reshape(group.recorded.shape)
        return Prediction(samples, self._table(group, read.slope, read.by_error, wanted) if sensitivities else None)

    def _observe(self, group: Group, motion: xr.Dataset, values: Floats, sensitivities: bool) -> Prediction:
        observer, place, quantity = group.observer, f"{group.run}/{group.name}", group.observer.quantity
        read = predicted_by(observer, place, motion, group.dataset, self._errors(group, values))
        take = partial(values_of, observer, place, read, like=group.dataset.variables[quantity])
        samples = take(quantity, more=()).reshape(group.recorded.shape)
        if not sensitivities:
            return Prediction(samples, None)
        slope = take(f"{quantity}_sensitivity", more=("parameter",)) if self._columns else None
        errors = [spec.name for spec in observer.errors] if group.name in self._wrong else []
        by_error = take(f"{quantity}_error_sensitivity", more=("error",)) if errors else np.empty((*samples.shape, 0))
        return Prediction(samples, self._table(group, slope, by_error, errors))

    def _errors(self, group: Group, values: Floats) -> SensorErrors:
        return instrument_errors(self.model, dict(zip(self.names, values.tolist(), strict=True))).get(group.name, {})

    def _table(self, group: Group, slope: np.ndarray | None, by_error: np.ndarray, errors: Sequence[str]) -> np.ndarray:
        """The derivatives (time, column, parameter) of what an instrument reads, those to `errors` of its own among them."""
        table = np.zeros((*group.recorded.shape, len(self.names)))
        if slope is not None:
            table[:, :, self._columns] = slope.reshape(*group.recorded.shape, -1)
        own = by_error.reshape(*group.recorded.shape, -1)
        for entry in (one for one in self.model.instruments if one.instrument == group.name):
            watched = [i for i, channel in enumerate(group.channels) if entry.sensor in _places(channel)]
            for name in entry.parameters:
                path = f"instrument.{entry.instrument}.{entry.sensor}.{name}"
                if path in self.names:
                    table[:, watched, self.names.index(path)] = own[:, watched, errors.index(name)]
        return table


def instrument_errors(model: Model, values: Mapping[str, float]) -> dict[str, dict[str, dict[str, float]]]:
    """The instruments' error parameters as Observers take them: by instrument, sensor and name."""
    errors: dict[str, dict[str, dict[str, float]]] = {}
    for entry in model.instruments:
        prefix = f"instrument.{entry.instrument}.{entry.sensor}."
        known = {name: values.get(prefix + name, parameter.value) for name, parameter in entry.parameters.items()}
        errors.setdefault(entry.instrument, {}).setdefault(entry.sensor, {}).update(known)
    return errors


def initial_state(recording: xr.DataTree, model: Model) -> xr.Dataset | None:
    """The recording's state at t = 0, if it holds one; a load that it does not know starts with its carrier."""
    node = recording.children.get("initial")
    if node is None:
        return None
    state = node.to_dataset(inherit=False)
    known = state.variables["body"].values.tolist()
    carried = [body for body in model.bodies if body.carrier in known and body.name not in known]
    if not carried:
        return state
    rows = [*range(len(known)), *(known.index(body.carrier) for body in carried)]
    names = xr.Variable("body", [*known, *(body.name for body in carried)])
    variables = {name: variable.isel(body=rows) for name, variable in state.variables.items() if "body" in variable.dims}
    coords = xr.Coordinates({"axis": state.variables["axis"], "body": names}, indexes={})  # building those takes longer
    return xr.Dataset({name: variable for name, variable in variables.items() if name != "body"}, coords)


def _read_of(readouts: Sequence[Readout | TurningReadout | None]) -> Integers | None:
    """The entries that these read, in order; None where one is unknown."""
    known = [readout for readout in readouts if readout is not None]
    return np.array(sorted(set().union(*(one.wanted for one in known)))) if len(known) == len(readouts) else None


def _moved(model: Model, compiled: Model) -> dict[str, float]:
    """Parameters of the structure that are fixed, at values other than the simulator's own."""
    own = compiled.parameters()
    fixed = {name: p.value for name, p in model.parameters().items() if p.fixed and not name.startswith("instrument.")}
    return {name: value for name, value in fixed.items() if value != own[name].value}


def _clock_margin(model: Model, stamps: Sequence[np.ndarray]) -> float:
    """How far a free clock may reach beyond the last time stamp."""
    reach = {"clock_offset": 1.0, "clock_rate": max((float(times.max(initial=0.0)) for times in stamps), default=0.0)}
    clocks = [{n: p for n, p in entry.parameters.items() if n in reach} for entry in model.instruments]
    margins = [[reach[n] * max(abs(p.lower), abs(p.upper)) for n, p in clock.items()] for clock in clocks]
    return max((sum(filter(np.isfinite, margin)) for margin in margins), default=0.0)


def _instants(stamps: Sequence[np.ndarray], margin: float) -> np.ndarray:
    """Every instant from t = 0 that some instrument reads, and on to `margin` after the last."""
    merged = np.unique(np.concatenate([[0.0], *stamps]))
    merged = merged[merged >= 0.0]
    merged = merged[np.concatenate([[True], np.diff(merged) > SAME_INSTANT])]
    if margin:
        merged = np.concatenate([merged, merged[-1] + np.linspace(0.0, margin, 1 + round(margin / 1e-4))[1:]])
    return merged


def _places(channel: Channel) -> tuple[str, ...]:
    """As which a model may name it: the whole instrument, the sensor, or one axis of that."""
    return "", channel.sensor, f"{channel.sensor}/{channel.axis}"
