"""Instruments at points of bodies that turn in the plane, read from the record of a run without a Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.data.channel_filter import ChannelFilter
from crashkit.mechanics import Simulator
from crashkit.mechanics.kernel.arrays import Floats, Integers, Record
from crashkit.mechanics.repeated_run import TURN, entry_of
from crashkit.protocols import Misread, PlainObserver, SensorErrors, Shown, TurningReading

KINDS = ("position", "velocity", "acceleration")
Motions = dict[str, Floats]
"""Along both axes and about their normal, by kind of `KINDS`: (time, channel, 3), or with a last dim of columns."""


@frozen(eq=False)
class TurningReadout:
    """What a point p sees of a body at x that is turned by the angle w, with r = R(w) p and r' = dr / dw.

    z = x + r; or x'' + w'' r' - w'^2 r, along the axes of the laboratory or of the body. Before contact the bodies go on
    uniformly, and nothing is felt.

    Arguments:
        quantity: of `TurningReading`.
        rows: of the record, one for each time stamp; the first for those before contact.
        early: (time stamp,) s, of those before contact.
        filter: of the channels, if they are filtered.
        entries: by kind of motion (channel, 3), of the record.
        along: (channel,) which axis of the model each shows.
        points: (channel, 2) m.
        own_axes: whether these axes turn with the body.
        nodes: s, times of the record.
        observer, instrument: of the group.
    """

    quantity: str
    rows: Integers | slice
    early: Floats
    filter: ChannelFilter | None
    entries: dict[str, Integers]
    along: Integers
    points: Floats
    own_axes: bool
    nodes: Floats
    observer: PlainObserver
    instrument: xr.Dataset

    def samples(self, record: Record) -> Floats:
        """(time, channel)."""
        motions = self._motions(record.values[self.rows])
        return self._shown(self._going_on(motions) if self.quantity == "position" else self._felt(motions))

    def sensitivity(self, record: Record) -> Floats:
        """(time, channel, column)."""
        if record.tangents.shape[2] == 0:
            return np.zeros((self.nodes[self.rows].size, len(self.along), 0))
        motions, changes = self._motions(record.values[self.rows]), self._motions(record.tangents[self.rows])
        return self._shown(
            self._going_on_slope(motions, changes) if self.quantity == "position" else self._felt_slope(motions, changes)
        )

    def misread(self, record: Record, errors: SensorErrors, wanted: Sequence[str], sensitivities: bool) -> Misread:
        """What the instrument records with these errors, with derivatives to those that are wanted and to the model's."""
        motions = self._motions(record.values)
        changes = self._motions(record.tangents) if sensitivities and record.tangents.shape[2] else None
        if self.quantity == "position":
            shown = Shown(self.nodes, self._place(motions), rate=self._speed(motions))
            if changes:
                slopes = self._place_slope(motions, changes), self._speed_slope(motions, changes)
                shown = Shown(self.nodes, shown.value, slopes[0], shown.rate, slopes[1])
        else:
            shown = Shown(self.nodes, self._felt(motions), self._felt_slope(motions, changes) if changes else None)
        return self.observer.misread(shown, self.instrument, errors, wanted)

    def _motions(self, table: Floats) -> Motions:
        return {kind: table[:, entries] for kind, entries in self.entries.items()}

    def _shown(self, readings: Floats) -> Floats:
        if self.quantity == "acceleration":
            readings[: len(self.early)] = 0.0
        return self.filter.filtered(readings, 0.0) if self.filter else readings

    def _arms(self, motions: Motions) -> tuple[Floats, Floats]:
        """r and r' along the axis of each channel, (time, channel)."""
        turn = motions["position"][:, :, 2]
        cos, sin = np.cos(turn), np.sin(turn)
        arms = cos * self.points[:, 0] - sin * self.points[:, 1], sin * self.points[:, 0] + cos * self.points[:, 1]
        return np.where(self.along == 0, *arms), np.where(self.along == 0, -arms[1], arms[0])

    def _along(self, motion: Floats) -> Floats:
        return motion[:, np.arange(len(self.along)), self.along]

    def _place(self, motions: Motions) -> Floats:
        return self._along(motions["position"]) + self._arms(motions)[0]

    def _place_slope(self, motions: Motions, changes: Motions) -> Floats:
        across, turned = self._arms(motions)[1], changes["position"][:, :, 2]
        return self._along(changes["position"]) + across[..., None] * turned

    def _speed(self, motions: Motions) -> Floats:
        return self._along(motions["velocity"]) + motions["velocity"][:, :, 2] * self._arms(motions)[1]

    def _speed_slope(self, motions: Motions, changes: Motions) -> Floats:
        arm, across = (part[..., None] for part in self._arms(motions))
        spin, turned = motions["velocity"][:, :, 2, None], changes["position"][:, :, 2]
        return self._along(changes["velocity"]) + changes["velocity"][:, :, 2] * across - spin * arm * turned

    def _going_on(self, motions: Motions) -> Floats:
        place, before = self._place(motions), len(self.early)
        if before:
            place[:before] += self.early[:, None] * self._speed(motions)[:before]
        return place

    def _going_on_slope(self, motions: Motions, changes: Motions) -> Floats:
        place, before = self._place_slope(motions, changes), len(self.early)
        if before:
            place[:before] += self.early[:, None, None] * self._speed_slope(motions, changes)[:before]
        return place

    def _felt(self, motions: Motions) -> Floats:
        arm, across = self._lever(motions)
        spin, turning = motions["velocity"][:, :, 2], motions["acceleration"][:, :, 2]
        return np.sum(self._directions(motions) * motions["acceleration"][:, :, :2], axis=2) + turning * across - spin**2 * arm

    def _felt_slope(self, motions: Motions, changes: Motions) -> Floats:
        arm, across = (part[..., None] for part in self._lever(motions))
        spin, turning = motions["velocity"][:, :, 2, None], motions["acceleration"][:, :, 2, None]
        directions, turned = self._directions(motions), changes["position"][:, :, 2]
        slope = np.einsum("tca,tcap->tcp", directions, changes["acceleration"][:, :, :2])
        slope += changes["acceleration"][:, :, 2] * across - 2.0 * spin * changes["velocity"][:, :, 2] * arm
        if not self.own_axes:
            return slope - (turning * arm + spin**2 * across) * turned
        # The axis e turns with the body: de / dw is e turned by a right angle.
        push = motions["acceleration"]
        aside = directions[:, :, 0] * push[:, :, 1] - directions[:, :, 1] * push[:, :, 0]
        return slope + aside[..., None] * turned

    def _lever(self, motions: Motions) -> tuple[Floats, Floats]:
        """r and r' along the axes that the channels sense along, (time, channel)."""
        if not self.own_axes:
            return self._arms(motions)
        first, second = self.points.T
        shape = motions["position"].shape[:2]
        lever = np.where(self.along == 0, first, second), np.where(self.along == 0, -second, first)
        return np.broadcast_to(lever[0], shape), np.broadcast_to(lever[1], shape)

    def _directions(self, motions: Motions) -> Floats:
        """Of the axes that the channels sense along, (time, channel, 2)."""
        turn = motions["position"][:, :, 2] if self.own_axes else np.zeros(motions["position"].shape[:2])
        cos, sin = np.cos(turn), np.sin(turn)
        first = self.along == 0
        return np.stack([np.where(first, cos, -sin), np.where(first, sin, cos)], axis=2)


def turning_readout_of(
    reading: TurningReading,
    simulator: Simulator,
    rows: Integers | slice,
    early: Floats,
    filter: ChannelFilter | None,
    nodes: Floats,
    observer: PlainObserver,
    instrument: xr.Dataset,
) -> TurningReadout | None:
    """The readout of a reading; None where the model's axes are not two that hold those of the instrument.

    Arguments:
        simulator: whose record is read.
        rows, early, filter, nodes, observer, instrument: as of `TurningReadout`.
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
        reading.quantity, rows, early, filter, entries, along, points, reading.own_axes, nodes, observer, instrument
    )
