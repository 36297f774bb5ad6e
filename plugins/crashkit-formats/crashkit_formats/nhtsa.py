"""The text files of the NHTSA Vehicle Crash Test Database."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen
from numpy.typing import NDArray

from crashkit.data.channel_filter import filter_channel
from crashkit.errors import CrashkitError
from crashkit.protocols import Importer
from crashkit_formats.curves import CurveFile, curve_files
from crashkit_formats.ev5 import Ev5, read_ev5
from crashkit_formats.options import Options, parse_options
from crashkit_formats.selection import Channel, select

Series = tuple[NDArray[np.float64], NDArray[np.float64]]  # time, value


@frozen
class Instrument:
    """What a sensor type becomes: the observer, its quantity, the factor to SI, and how curves are joined."""

    observer: str
    quantity: str
    units: str
    factor: float
    join: str


INSTRUMENTS = {
    ("AC", "G'S"): Instrument("accelerometer", "acceleration", "m s-2", 9.80665, "mean"),
    ("LC", "NWT"): Instrument("load_cell", "force", "N", 1.0, "sum"),
}


class NhtsaImporter(Importer):
    """Reads a folder that holds one EV5 file and a file for each curve, loose or in tar archives."""

    name: ClassVar[str] = "nhtsa"

    def channels(self, source: Path) -> xr.Dataset:
        """The curves of the EV5 file, with the number of samples that are there (0: no data file)."""
        test, files = read_ev5(source), curve_files(source)
        curves = list(test.curves.values())
        texts = ("sensor_type", "location", "axis", "unit", "comment")
        content = {name: ("channel", np.array([getattr(curve, name) for curve in curves], dtype=object)) for name in texts}
        samples = np.array([files[curve.number].samples if curve.number in files else 0 for curve in curves])
        return xr.Dataset(
            {**content, "present": ("channel", samples > 0), "samples": ("channel", samples)},
            coords={"channel": np.array([curve.number for curve in curves])},
            attrs={"title": test.title},
        )

    def read(self, source: Path, channels: Sequence[str], options: Mapping[str, str]) -> xr.DataTree:
        """The chosen curves as a recording in one axis.

        Joined accelerometers are averaged, joined load cells are summed. Accelerations stay in the vehicle's frame of the
        database, taken as the laboratory's.

        Arguments:
            source: the folder.
            channels: each "[-]CURVE[+CURVE...]=BODY[:SENSOR]"; "CURVE..CURVE" is a range, "-" flips the sign.
            options: `window`, `channel_frequency_class`, `zero`, `speed`, `position`; see `Options`.
        """
        if not channels:
            raise CrashkitError("expected at least one channel like 93+94=vehicle:compartment, found none")
        chosen, test, files = parse_options(options), read_ev5(source), curve_files(source)
        selected = [select(text, test, files.keys()) for text in channels]
        axis = _axis(selected)
        groups = {"/": xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": test.title})}
        groups["/initial"] = _initial(selected, test, chosen, axis)
        for instrument in dict.fromkeys(_instrument(channel) for channel in selected):
            members = [channel for channel in selected if _instrument(channel) == instrument]
            groups[f"/{instrument.observer}"] = _group(instrument, members, files, chosen, axis)
        return xr.DataTree.from_dict(groups)


def _instrument(channel: Channel) -> Instrument:
    curve = channel.curves[0]
    if (curve.sensor_type, curve.unit) not in INSTRUMENTS:
        known = " or ".join(" in ".join(kind) for kind in INSTRUMENTS)
        raise CrashkitError(f"curve {curve.number}: expected {known}, found {curve.sensor_type} in {curve.unit}")
    return INSTRUMENTS[curve.sensor_type, curve.unit]


def _axis(selected: Sequence[Channel]) -> str:
    axes = sorted({channel.curves[0].axis[:1].lower() for channel in selected})
    if len(axes) > 1 or axes[0] not in "xyz":
        raise CrashkitError(f"expected channels of one axis x, y or z, found {', '.join(axes)}")
    return axes[0]


def _initial(selected: Sequence[Channel], test: Ev5, options: Options, axis: str) -> xr.Dataset:
    """Bodies with curves of a vehicle start at the closing speed, those of the barrier at rest."""
    vehicles = {channel.body: channel.curves[0].vehicle for channel in selected}
    if max(vehicles.values()) > 1 and not set(vehicles) <= set(options.speed):
        raise CrashkitError("two vehicles: expected the option speed for every body, like speed=first:13.9,second:-13.9")
    for name, given in (("speed", options.speed), ("position", options.position)):
        if strange := sorted(set(given) - set(vehicles) - {""}):
            raise CrashkitError(f"option {name}: expected one of the bodies {', '.join(vehicles)}, found {', '.join(strange)}")
    moving = options.speed.get("", test.closing_speed if axis == "x" else 0.0)
    velocity = [options.speed.get(body, moving if vehicle else 0.0) for body, vehicle in vehicles.items()]
    position = [options.position.get(body, options.position.get("", 0.0)) for body in vehicles]
    return xr.Dataset(
        {
            "position": (("body", "axis"), np.array(position)[:, None], {"units": "m"}),
            "velocity": (("body", "axis"), np.array(velocity)[:, None], {"units": "m s-1"}),
        },
        coords={"body": list(vehicles), "axis": [axis]},
    )


def _group(
    instrument: Instrument, members: Sequence[Channel], files: Mapping[int, CurveFile], options: Options, axis: str
) -> xr.Dataset:
    names = [channel.sensor for channel in members]
    if len(set(names)) < len(names):
        raise CrashkitError(f"expected a name of its own for each {instrument.observer}, found {', '.join(names)}")
    time, values = _common([_series(instrument, channel, files, options) for channel in members], names)
    attrs: dict[str, object] = {
        "observer": instrument.observer,
        "channel_frequency_class": options.channel_frequency_class,
    }
    if instrument.observer == "accelerometer":
        attrs["frame"] = "laboratory"
    curves = ["+".join(str(curve.number) for curve in channel.curves) for channel in members]
    return xr.Dataset(
        {
            instrument.quantity: (("time", "sensor", "axis"), values[:, :, None], {"units": instrument.units}),
            "sensor_body": ("sensor", np.array([channel.body for channel in members], dtype=object)),
            "sensor_point": (("sensor", "axis"), np.zeros((len(members), 1)), {"units": "m"}),
            "sensor_curves": ("sensor", np.array(curves, dtype=object)),
        },
        coords={"time": ("time", time, {"units": "s"}), "sensor": names, "axis": [axis]},
        attrs=attrs,
    )


def _series(instrument: Instrument, channel: Channel, files: Mapping[int, CurveFile], options: Options) -> Series:
    """One sensor: its curves joined, offset taken off, filtered, then cut to the window."""
    if channel.skipped:
        skipped = ", ".join(f"{curve.number} ({curve.comment})" for curve in channel.skipped)
        warnings.warn(f"sensor {channel.sensor}: left out curves without valid data: {skipped}", stacklevel=2)
    time, value = _joined(instrument, [files[curve.number] for curve in channel.curves])
    value = value * channel.sign * instrument.factor
    value = value - _offset(channel, time, value, options)
    if options.channel_frequency_class:
        value = filter_channel(value, time, options.channel_frequency_class)
    kept = (time >= options.window[0] - 1e-9) & (time <= options.window[1] + 1e-9)
    if kept.sum() < 2:
        raise CrashkitError(f"sensor {channel.sensor}: expected samples within the window, found {int(kept.sum())}")
    return time[kept], value[kept]


def _joined(instrument: Instrument, files: Sequence[CurveFile]) -> Series:
    """The mean or the sum of the curves over the time that all of them share."""
    curves = [file.values() for file in files]
    time = min((time for time, _ in curves), key=len)
    total = np.zeros(len(time))
    for file, (own, value) in zip(files, curves, strict=True):
        if not np.array_equal(own[: len(time)], time):
            raise CrashkitError(f"{file.place}: expected the time stamps of {files[0].place}, found others")
        total += value[: len(time)]
    return time, total / len(files) if instrument.join == "mean" else total


def _offset(channel: Channel, time: NDArray[np.float64], value: NDArray[np.float64], options: Options) -> float:
    if options.zero is None:
        return 0.0
    before = (time >= options.zero[0] - 1e-9) & (time <= options.zero[1] + 1e-9)
    if not before.any():
        raise CrashkitError(
            f"sensor {channel.sensor}: expected samples between {options.zero[0]:g} and {options.zero[1]:g} s "
            f"to take the offset from, found the first at {time[0]:g} s (option zero=off keeps the offset)"
        )
    return float(value[before].mean())


def _common(series: Sequence[Series], names: Sequence[str]) -> Series:
    """All sensors on the longest time base; shorter ones end in NaN."""
    time = max((time for time, _ in series), key=len)
    values = np.full((len(time), len(series)), np.nan)
    for column, (own, value) in enumerate(series):
        if not np.array_equal(own, time[: len(own)]):
            raise CrashkitError(f"sensor {names[column]}: expected the time stamps of the other sensors, found others")
        values[: len(own), column] = value
    return time, values
