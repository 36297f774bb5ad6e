"""Instruments that show single numbers of a run, read from its record without a Dataset."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.data.channel_filter import ChannelFilter, frequency_class, since_contact
from crashkit.mechanics import Simulator
from crashkit.mechanics.kernel.arrays import Floats, Integers, Record
from crashkit.mechanics.repeated_run import FORCE, entry_of, supports_of
from crashkit.misfit.channel import Group
from crashkit.misfit.turning_readout import TurningReadout, turning_readout_of
from crashkit.protocols import Misread, PlainObserver, SensorErrors, Shown, TurningReading


@frozen(eq=False)
class Readout:
    """Where a group's channels stand in the record of a run.

    Arguments:
        rows: of the record, one for each time stamp, a slice where they are evenly spread; the first for those before contact.
        remembered: how many of them, the first, are of no sample, but of what a filter remembers since contact.
        entries: of the record, one for each channel; of a full one, or of one that holds what is `wanted`.
        unfelt: for each channel, what the entry counts that the instrument does not feel: other entries, and times what.
        rates: the entries of their rates, where the motion before contact changes them.
        early: (time stamp, 1) s, of those before contact.
        is_still: whether the channels show nothing before contact.
        filter: of the channels, if they are filtered.
        offset: (channel,) added to what they show.
        observer, instrument: of the group.
        nodes: s, times of the record.
    """

    rows: Integers | slice
    remembered: int
    entries: Integers
    unfelt: Sequence[Mapping[int, float]]
    rates: Integers
    early: Floats
    is_still: bool
    filter: ChannelFilter | None
    offset: Floats
    observer: PlainObserver
    instrument: xr.Dataset
    nodes: Floats

    @property
    def wanted(self) -> set[int]:
        """The entries that it reads."""
        return {*self.entries.tolist(), *self.rates.tolist()}.union(*self.unfelt)

    def within(self, wanted: Integers) -> "Readout":
        """The same of a record that holds these entries alone, in this order."""
        entries, rates = (np.searchsorted(wanted, part) for part in (self.entries, self.rates))
        unfelt = [{int(np.searchsorted(wanted, entry)): n for entry, n in part.items()} for part in self.unfelt]
        return evolve(self, entries=entries, rates=rates, unfelt=unfelt)

    def samples(self, record: Record) -> Floats:
        """(time, channel)."""
        return self._read(record.values) + self.offset

    def sensitivity(self, record: Record) -> Floats:
        """(time, channel, column)."""
        if record.tangents.shape[2] == 0:
            return np.zeros((self.nodes[self.rows].size - self.remembered, len(self.entries), 0))
        return self._read(record.tangents)

    def misread(self, record: Record, errors: SensorErrors, wanted: Sequence[str], sensitivities: bool) -> Misread:
        """What the instrument records with these errors, with derivatives to those that are wanted and to the model's."""
        value, rate = self._courses(record.values)
        slopes = self._courses(record.tangents) if sensitivities and record.tangents.shape[2] else (None, None)
        shown = Shown(self.nodes, value + self.offset, slopes[0], rate, slopes[1])
        return self.observer.misread(shown, self.instrument, errors, wanted)

    def _courses(self, record: Floats) -> tuple[Floats, Floats | None]:
        """What is shown at every node, and its rate where that is known."""
        return self._felt(record), record[:, self.rates] if self.rates.size else None

    def _felt(self, record: Floats) -> Floats:
        """What the channels show at all rows."""
        shown = record.take(self.entries, axis=1)
        for channel, others in enumerate(self.unfelt):
            for entry, times in others.items():
                shown[:, channel] -= times * record[:, entry]
        return shown

    def _read(self, record: Floats) -> Floats:
        # A slice of a record is no copy; of other rows, those of the entries alone are a smaller one.
        shown = self._felt(record[self.rows]) if isinstance(self.rows, slice) else self._felt(record)[self.rows]
        before = len(self.early)
        if before and self.is_still:
            shown[:before] = 0.0
        elif before and self.rates.size:
            shown[:before] += self.early.reshape(-1, *(1,) * (shown.ndim - 1)) * record[0, self.rates]
        return self.filter.filtered(shown, 0.0)[self.remembered :] if self.filter else shown


def knows_what_is_shown(group: Group, wrong: Collection[str], axes: set[str]) -> bool:
    """Whether what the channels show is all that these errors of the group ask for, in a model of such axes.

    In several axes a sensor may feel across those that it records, and one that sits elsewhere on a body that turns feels
    another motion: of that only its observer knows.
    """
    if len(axes) == 1 or not wrong:
        return True
    observer, own = group.observer, set(group.dataset.variables["axis"].values.tolist())
    return isinstance(observer, PlainObserver) and own == axes and not set(wrong) & set(observer.place_errors)


def readout_of(
    group: Group, simulator: Simulator, nodes: Floats, turning: bool, tolerance: float, is_misread: bool
) -> Readout | TurningReadout | None:
    """The readout of a group; None where only its observer knows what it reads.

    Arguments:
        group: of the recording.
        simulator: whose record is read.
        nodes: s, times of the record; they hold 0 and all later instants of the group to within `tolerance`, s.
        turning: whether the bodies of the model may turn.
        is_misread: whether it is asked what the instrument misreads.
    """
    if not isinstance(group.observer, PlainObserver):
        return None
    reading = group.observer.reading(group.dataset, turning)
    if reading is None or group.times.max(initial=0.0) > nodes[-1] + tolerance:
        return None
    times, cfc = instants_of(group), frequency_class(group.dataset)
    rows, remembered = _as_slice(np.searchsorted(nodes, np.maximum(times - tolerance, 0.0))), len(times) - len(group.times)
    early = times[times < 0.0]
    filter = ChannelFilter.of(group.times, cfc) if cfc and len(group.times) > 1 else None
    if isinstance(reading, TurningReading):
        return turning_readout_of(reading, simulator, rows, remembered, early, filter, nodes, group.observer, group.dataset)
    places = list(zip(reading.bodies, reading.axes, strict=True))
    entries = [entry_of(simulator, reading.quantity, body, axis) for body, axis in places]
    if None in entries:
        return None
    has_rates = reading.quantity == "position" and (is_misread or early.size > 0)
    rates = [entry_of(simulator, "velocity", body, axis) for body, axis in places] if has_rates else []
    return Readout(
        rows=rows,
        remembered=remembered,
        entries=np.array(entries, int),
        unfelt=[supports_of(simulator, body) for body, _ in places] if reading.quantity == FORCE else [],
        rates=np.array(rates, int),
        early=early,
        is_still=reading.quantity not in ("position", "velocity"),
        filter=filter,
        offset=reading.offset,
        observer=group.observer,
        instrument=group.dataset,
        nodes=nodes,
    )


def instants_of(group: Group) -> Floats:
    """When a group is read, s: at its time stamps, and before those since contact where a filter remembers that."""
    return np.concatenate([since_contact(group.times), group.times]) if frequency_class(group.dataset) else group.times


def _as_slice(rows: Integers) -> Integers | slice:
    """Rows that are evenly spread as a slice, which is read many times faster."""
    steps = np.diff(rows)
    if not len(steps) or steps[0] < 1 or (steps != steps[0]).any():
        return rows
    return slice(int(rows[0]), int(rows[-1]) + 1, int(steps[0]))
