"""The misfit between a model and recordings in measurement space: what an Identifier minimises."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.mechanics import Engine, Simulator
from crashkit.misfit.apart import kept_apart
from crashkit.misfit.channel import Channel, Group, as_heard_of, groups_of, reweighted
from crashkit.misfit.coarse import COARSER, coarse_group, early_group
from crashkit.misfit.fine_step import crude_step
from crashkit.misfit.noise import Noise
from crashkit.misfit.predictor import STEP, Prediction, Predictor
from crashkit.misfit.rows import Rows, rows_of
from crashkit.misfit.variables import NO_PRIOR, Prior, SearchVariables, sums_of_free
from crashkit.model import Model
from crashkit.protocols import Laws, Observer


class Misfit(SearchVariables):
    """Weighted residuals (recorded - predicted) / std of a model over recordings; a Problem for identifiers.

    Arguments:
        model: its free parameters are the unknowns.
        recordings: by run name.
        laws, observers: installed plugins by name.
        engine: a compiled engine that holds the model's laws; None compiles one.
        step: s, longest step of the integration; see `fine_step`.
    """

    def __init__(
        self,
        model: Model,
        recordings: Mapping[str, xr.DataTree],
        laws: Laws,
        observers: Mapping[str, type[Observer]],
        engine: Engine | None = None,
        step: float = STEP,
    ) -> None:
        groups = [group for run, tree in recordings.items() for group in groups_of(run, tree, observers, model)]
        self._setup(model, recordings, groups, Simulator(model, laws, engine), step)

    def _setup(
        self,
        model: Model,
        recordings: Mapping[str, xr.DataTree],
        groups: Sequence[Group],
        simulator: Simulator,
        step: float = STEP,
        prior: Prior = NO_PRIOR,
        predictor: Predictor | None = None,
    ) -> None:
        super().__init__(kept_apart(model, simulator.layout.increasing()), prior, sums_of_free(model))
        self.model = model
        self.recordings = recordings
        self.simulator = simulator
        self.groups = tuple(groups)
        self.step = step
        self._shared = predictor

    @cached_property
    def predictor(self) -> Predictor:
        """Of what the instruments would read; made when it is first asked or shared: of many models only bounds are."""
        return self._shared or Predictor(self.model, self.recordings, self.groups, self.simulator, self.step)

    @cached_property
    def _rows(self) -> list[Rows]:
        return [rows_of(group) for group in self.groups]

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Every channel, in the order of the residuals."""
        return tuple(channel for group in self.groups for channel in group.channels)

    @property
    def independent_samples(self) -> float:
        """How many independent readings all channels amount to."""
        return sum(channel.independent_samples for channel in self.channels)

    @property
    def sample_count(self) -> int:
        """How many residuals are of samples that were recorded."""
        return sum(len(rows.recorded) for rows in self._rows)

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """Weighted residuals, one for each sample that was recorded; a sample that the simulation does not reach has 0.

        What is known of parameters beforehand follows, one residual for each.
        """
        return np.concatenate([self.discrepancy(scaled), self._departure(scaled)])

    def discrepancy(self, scaled: np.ndarray) -> np.ndarray:
        """Weighted residuals of the samples alone."""
        residual = self._residual(self.predictor.predict_at(self.parameters(scaled)))
        residual[np.isnan(residual)] = 0.0
        return residual

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weighted residuals and their derivatives to the search variables."""
        predictions = self.predictor.predict_at(self.parameters(scaled), sensitivities=True)
        departure, own = self.belief(scaled)
        residual = np.concatenate([self._residual(predictions), departure])
        jacobian, scaling, start = np.empty((len(residual), len(scaled))), self.scaling(scaled), 0
        for rows, prediction in zip(self._rows, predictions, strict=True):
            rows.jacobian(prediction, scaling, jacobian[start : (start := start + len(rows.recorded))])
        jacobian[start:] = own
        unknown = np.isnan(residual)
        if unknown.any():
            residual[unknown], jacobian[unknown] = 0.0, 0.0
        return residual, jacobian

    def channel_sums(self, residual: np.ndarray) -> np.ndarray:
        """The sum of squares of each channel's weighted residuals; a channel at its noise gives its independent samples."""
        sums, start = [], 0
        for group, rows in zip(self.groups, self._rows, strict=True):
            squares = np.zeros(group.recorded.size)
            squares[rows.kept] = residual[start : (start := start + len(rows.recorded))] ** 2
            sums.append(squares.reshape(group.recorded.shape).sum(axis=0))
        return np.concatenate(sums)

    def deviance(self, residual: np.ndarray) -> float:
        """Minus twice the log likelihood, up to a constant: of all channels, and of what is known of parameters beforehand."""
        known = float(np.sum(residual[self.sample_count :] ** 2))
        return known + float(np.sum(self.channel_deviances(residual)))

    def channel_deviances(self, residual: np.ndarray) -> np.ndarray:
        """Minus twice the log likelihood of each channel, up to a constant.

        A channel with a trusted noise level counts its sum of squares; one whose level is only estimated counts
        `n log(std^2 sum / n)`, the likelihood with the level left open, whatever its weight.
        """
        sums = zip(self.channels, self.channel_sums(residual), strict=True)
        return np.array([_deviance(channel, float(total)) for channel, total in sums])

    def reweighted(self, scaled: np.ndarray) -> "Misfit":
        """The same misfit with open noise levels set to what the model leaves of those channels."""
        return self._with_noise(scaled, reweighted)

    def as_heard(self, scaled: np.ndarray) -> "Misfit":
        """The same misfit where channels that state too little noise have what the model leaves of them, if that is white."""
        return self._with_noise(scaled, as_heard_of)

    def _with_noise(self, scaled: np.ndarray, heard: Callable[[Group, int, np.ndarray], Channel]) -> "Misfit":
        predictions = self.predictor.predict_at(self.parameters(scaled))
        left = [
            group.recorded - one.samples.reshape(group.recorded.shape)
            for group, one in zip(self.groups, predictions, strict=True)
        ]
        levels = [
            tuple(heard(g, i, one[:, i]) for i in range(len(g.channels))) for g, one in zip(self.groups, left, strict=True)
        ]
        return self._with(groups=[evolve(g, channels=own) for g, own in zip(self.groups, levels, strict=True)])

    def with_levels(self, levels: Mapping[tuple[str, str, str], Noise]) -> "Misfit":
        """The same misfit with the noise levels of others for some channels, by (instrument, sensor, axis); of those that are
        louder than stated with as many times what is stated here."""
        return self._with(groups=[evolve(g, channels=tuple(_levelled(c, levels) for c in g.channels)) for g in self.groups])

    def without_sensor(self, instrument: str, sensor: str) -> "Misfit":
        """The same misfit as if a sensor had recorded nothing."""
        return self._with(groups=[one.without(sensor) if one.name == instrument else one for one in self.groups])

    def with_model(self, model: Model, laws: Laws, engine: Engine | None = None) -> "Misfit":
        """The misfit of another model to the same recordings, with the same weights."""
        return self._with(model=model, simulator=Simulator(model, laws, engine))

    def with_values(self, values: Mapping[str, float], free: Mapping[str, bool] | None = None) -> "Misfit":
        """The misfit of the same structure at other values; `free` frees or fixes parameters by path."""
        model = self.model.at(values)
        if free:
            known = model.parameters()
            model = model.with_parameters({path: evolve(known[path], fixed=not is_free) for path, is_free in free.items()})
        # A predictor is told the values of free parameters whenever it is asked: only others make it another one.
        is_same = not free and values.keys() <= set(self.names)
        return self._with(model=model, predictor=self.predictor if is_same else None)

    def with_values_of(self, other: "Misfit") -> "Misfit":
        """The same misfit with the numbers that its model shares with another's where they stand in that."""
        known = other.values(other.start())
        return self.with_values({name: known[name] for name in self.names if name in known})

    def with_prior(self, std: float) -> "Misfit":
        """The same misfit when its model's values are known to about `std`, relative to each; of zeros nothing is known."""
        return self._with(prior=self.known_to(std), predictor=self.predictor)

    def with_recordings(self, runs: tuple[str, ...]) -> "Misfit":
        """The same misfit over some of the runs."""
        chosen = {run: self.recordings[run] for run in runs}
        return self._with(recordings=chosen, groups=[group for group in self.groups if group.run in chosen])

    def with_step(self, step: float) -> "Misfit":
        """The same misfit with another longest step of the integration, s."""
        return self._with(step=step)

    @cached_property
    def coarse(self) -> "Misfit":
        """The same at fewer instants and in steps of the integration as long as these bear, for first guesses."""
        thin = self._with(groups=[coarse_group(group) for group in self.groups], step=COARSER * self.step)
        return thin.with_step(crude_step(thin))

    def up_to(self, share: float) -> "Misfit":
        """The same over the first part of the time recorded: what happens early is known before what happens late."""
        end = share * max(float(group.times[-1]) for group in self.groups)
        early = [one for one in (early_group(group, end) for group in self.groups) if one is not None]
        return self._with(groups=early)

    def at_speed(self, factor: float) -> "Misfit":
        """The same instruments in tests with all initial velocities multiplied, to ask what such tests would show."""
        faster = {run: _faster(recording, factor) for run, recording in self.recordings.items()}
        return self._with(recordings=faster, prior=NO_PRIOR)

    def _with(self, **changes: Any) -> "Misfit":
        """Another misfit, made without a look at its recordings."""
        names = ("model", "recordings", "groups", "simulator", "step", "prior")
        copy = object.__new__(Misfit)
        copy._setup(**({name: getattr(self, name) for name in names} | changes))
        return copy

    def _residual(self, predictions: list[Prediction]) -> np.ndarray:
        return np.concatenate([rows.residual(prediction) for rows, prediction in zip(self._rows, predictions, strict=True)])


def _faster(recording: xr.DataTree, factor: float) -> xr.DataTree:
    state = recording.children["initial"].to_dataset(inherit=False)
    return recording.assign({"initial": xr.DataTree(state.assign(velocity=factor * state["velocity"]))})


def _deviance(channel: Channel, total: float) -> float:
    if channel.noise.trusted:
        return total
    count, noise = channel.independent_samples, channel.noise
    return count * float(np.log(max(noise.std**2 * total / count, noise.least**2))) if count else 0.0


def _levelled(channel: Channel, levels: Mapping[tuple[str, str, str], Noise]) -> Channel:
    own = channel.noise
    level = levels.get((channel.instrument, channel.sensor, channel.axis), own)
    # Of thinned recordings what is stated is less: only how much more there is holds for both.
    std = own.std * level.louder / own.louder if level.louder > 1.0 else level.std
    return evolve(channel, noise=evolve(own, std=std, least=level.least, louder=level.louder))
