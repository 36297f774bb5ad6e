"""Instruments at points of bodies that turn in the plane, read from the record of a run without a Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.data.channel_filter import ChannelFilter
from crashkit.mechanics import Simulator
from crashkit.mechanics.kernel.arrays import Floats, Integers, Record
from crashkit.mechanics.repeated_run import TURN, entry_of
from crashkit.protocols import Misread, PlainObserver, SensorErrors, Shown, TurningReading

KINDS = ("position", "velocity", "acceleration")
ABOUT = 2
"""The place of what goes on about the normal of both axes, behind these."""


@frozen(eq=False)
class TurningReadout:
    """What a point p sees of a body at x that is turned by the angle w, with r = R(w) p and r' = dr / dw.

    z = x + r; or x'' + w'' r' - w'^2 r, along the axes of the laboratory or of the body. Before contact the bodies go on
    uniformly, and nothing is felt.

    Arguments:
        quantity: of `TurningReading`.
        rows: of the record, one for each time stamp; the first for those before contact.
        remembered: how many of them, the first, are of no sample, but of what a filter remembers since contact.
        early: (time stamp,) s, of those before contact.
        filter: of the channels, if they are filtered.
        entries: by kind of motion (channel, 3), of the record: along both axes, and about their normal; as of `Readout`.
        along: (channel,) which axis of the model each shows.
        points: (channel, 2) m.
        own_axes: whether these axes turn with the body.
        nodes: s, times of the record.
        observer, instrument: of the group.
    """

    quantity: str
    rows: Integers | slice
    remembered: int
    early: Floats
    filter: ChannelFilter | None
    entries: dict[str, Integers]
    along: Integers
    points: Floats
    own_axes: bool
    nodes: Floats
    observer: PlainObserver
    instrument: xr.Dataset

    @property
    def wanted(self) -> set[int]:
        """The entries that it reads."""
        return set(np.concatenate([entries.ravel() for entries in self.entries.values()]).tolist())

    def within(self, wanted: Integers) -> "TurningReadout":
        """The same of a record that holds these entries alone, in this order."""
        return evolve(self, entries={kind: np.searchsorted(wanted, entries) for kind, entries in self.entries.items()})

    def samples(self, record: Record) -> Floats:
        """(time, channel)."""
        table = record.values[self.rows]
        return self._shown(self._going_on(table) if self.quantity == "position" else self._felt(table))

    def sensitivity(self, record: Record) -> Floats:
        """(time, channel, column)."""
        if record.tangents.shape[2] == 0:
            return np.zeros((self.nodes[self.rows].size - self.remembered, len(self.along), 0))
        table, changes = record.values[self.rows], record.tangents[self.rows]
        is_place = self.quantity == "position"
        return self._shown(self._going_on_slope(table, changes) if is_place else self._felt_slope(table, changes))

    def misread(self, record: Record, errors: SensorErrors, wanted: Sequence[str], sensitivities: bool) -> Misread:
        """What the instrument records with these errors, with derivatives to those that are wanted and to the model's."""
        table, changes = record.values, record.tangents
        has_slopes, slope, rate, rate_slope = sensitivities and changes.shape[2] > 0, None, None, None
        if self.quantity == "position":
            value, rate = self._place(table), self._speed(table)
            if has_slopes:
                slope, rate_slope = self._place_slope(table, changes), self._speed_slope(table, changes)
        else:
            value = self._felt(table)
            if has_slopes:
                slope = self._felt_slope(table, changes)
        return self.observer.misread(Shown(self.nodes, value, slope, rate, rate_slope), self.instrument, errors, wanted)

    def _shown(self, readings: Floats) -> Floats:
        if self.quantity == "acceleration":
            readings[: len(self.early)] = 0.0
        return self.filter.filtered(readings, 0.0)[self.remembered :] if self.filter else readings

    def _along(self, table: Floats, kind: str) -> Floats:
        """A motion of the bodies along the axis of each channel, (time, channel) or with a last dim of columns."""
        return table[:, self.entries[kind][np.arange(len(self.along)), self.along]]

    def _component(self, table: Floats, kind: str, axis: int) -> Floats:
        """The same along the first or the second axis of the model, or about their normal."""
        return table[:, self.entries[kind][:, axis]]

    def _arms(self, table: Floats) -> tuple[Floats, Floats]:
        """r and r' along the axis of each channel, (time, channel)."""
        turn = self._component(table, "position", ABOUT)
        cos, sin = np.cos(turn), np.sin(turn)
        arms = cos * self.points[:, 0] - sin * self.points[:, 1], sin * self.points[:, 0] + cos * self.points[:, 1]
        return np.where(self.along == 0, *arms), np.where(self.along == 0, -arms[1], arms[0])

    def _place(self, table: Floats) -> Floats:
        return self._along(table, "position") + self._arms(table)[0]

    def _place_slope(self, table: Floats, changes: Floats) -> Floats:
        across = self._arms(table)[1][..., None]
        return self._along(changes, "position") + across * self._component(changes, "position", ABOUT)

    def _speed(self, table: Floats) -> Floats:
        return self._along(table, "velocity") + self._component(table, "velocity", ABOUT) * self._arms(table)[1]

    def _speed_slope(self, table: Floats, changes: Floats) -> Floats:
        arm, across = (part[..., None] for part in self._arms(table))
        spin = self._component(table, "velocity", ABOUT)[..., None]
        turned, spun = (self._component(changes, kind, ABOUT) for kind in ("position", "velocity"))
        return self._along(changes, "velocity") + spun * across - spin * arm * turned

    def _going_on(self, table: Floats) -> Floats:
        place, before = self._place(table), len(self.early)
        if before:
            place[:before] += self.early[:, None] * self._speed(table[:before])
        return place

    def _going_on_slope(self, table: Floats, changes: Floats) -> Floats:
        place, before = self._place_slope(table, changes), len(self.early)
        if before:
            place[:before] += self.early[:, None, None] * self._speed_slope(table[:before], changes[:before])
        return place

    def _felt(self, table: Floats) -> Floats:
        arm, across = self._lever(table)
        spin, twist = (self._component(table, kind, ABOUT) for kind in ("velocity", "acceleration"))
        return self._pushed(table, self._directions(table)) + twist * across - spin**2 * arm

    def _felt_slope(self, table: Floats, changes: Floats) -> Floats:
        arm, across = (part[..., None] for part in self._lever(table))
        spin, twist = (self._component(table, kind, ABOUT)[..., None] for kind in ("velocity", "acceleration"))
        turned, spun, twisted = (self._component(changes, kind, ABOUT) for kind in KINDS)
        first, second = directions = self._directions(table)
        slope = self._pushed(changes, [one[..., None] for one in directions]) + twisted * across - 2.0 * spin * spun * arm
        if not self.own_axes:
            return slope - (twist * arm + spin**2 * across) * turned
        # The axis e turns with the body: de / dw is e turned by a right angle.
        aside = first * self._component(table, "acceleration", 1) - second * self._component(table, "acceleration", 0)
        return slope + aside[..., None] * turned

    def _pushed(self, table: Floats, directions: Sequence[Floats]) -> Floats:
        """The accelerations of the bodies, or their changes, along the axes that the channels sense along."""
        if not self.own_axes:
            return self._along(table, "acceleration")
        first, second = directions
        return first * self._component(table, "acceleration", 0) + second * self._component(table, "acceleration", 1)

    def _lever(self, table: Floats) -> tuple[Floats, Floats]:
        """r and r' along the axes that the channels sense along, (time, channel)."""
        if not self.own_axes:
            return self._arms(table)
        first, second = self.points.T
        shape = len(table), len(self.along)
        lever = np.where(self.along == 0, first, second), np.where(self.along == 0, -second, first)
        return np.broadcast_to(lever[0], shape), np.broadcast_to(lever[1], shape)

    def _directions(self, table: Floats) -> tuple[Floats, Floats]:
        """Of axes that turn with the bodies and that the channels sense along, (time, channel) along each of the model's."""
        turn = self._component(table, "position", ABOUT)
        cos, sin = np.cos(turn), np.sin(turn)
        return np.where(self.along == 0, cos, -sin), np.where(self.along == 0, sin, cos)


def turning_readout_of(
    reading: TurningReading,
    simulator: Simulator,
    rows: Integers | slice,
    remembered: int,
    early: Floats,
    filter: ChannelFilter | None,
    nodes: Floats,
    observer: PlainObserver,
    instrument: xr.Dataset,
) -> TurningReadout | None:
    """The readout of a reading; None where the model's axes are not two that hold those of the instrument.

    Arguments:
        simulator: whose record is read.
        rows, remembered, early, filter, nodes, observer, instrument: as of `TurningReadout`.
    """
    axes = simulator.model.axes
    if len(axes) != 2 or not set(reading.channels) <= set(axes):
        return None
    entries = {
        kind: np.array(
            [[entry_of(simulator, kind, body, axis) for axis in (*axes, TURN)] for body in reading.bodies], dtype=int
        )
        for kind in KINDS
    }
    points = np.zeros((len(reading.bodies), 2))
    points[:, [axes.index(axis) for axis in reading.axes]] = reading.points
    along = np.array([axes.index(axis) for axis in reading.channels])
    return TurningReadout(
        reading.quantity,
        rows,
        remembered,
        early,
        filter,
        entries,
        along,
        points,
        reading.own_axes,
        nodes,
        observer,
        instrument,
    )
