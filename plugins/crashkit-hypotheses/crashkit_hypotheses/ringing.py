"""At which frequencies a sensor's readings ring beside the motion of its body."""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr
from scipy.signal import find_peaks, periodogram

from crashkit.registry import load
from crashkit_hypotheses.sensors import Sensor

LOWEST, SLOW, HIGHEST = 30.0, 60.0, 5e3
"""Hz; below the second, structures move, too; above the last, a mount is as good as rigid."""
UNSEEN = (150.0, 500.0)
"""Hz, where nothing can be compared."""
FEWEST = 8
"""Frequencies of a spectrum: with fewer, no peak is told from its neighbours, of which five are averaged."""


def ringing_frequencies(sensor: Sensor, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> tuple[float, ...]:
    """The peaks that stand out most in the spectra of readings minus motion, Hz, over all recordings: two, and a slow one."""
    spectra = [spectrum for spectrum in _spectra(sensor, motion, recordings) if len(spectrum[0]) > FEWEST]
    if not spectra:
        return UNSEEN
    frequency = spectra[0][0]
    density = np.mean([np.interp(frequency, *spectrum) for spectrum in spectra], axis=0)
    excess = density - _level(frequency, density)
    quick, slow = (_highest(frequency, excess, band) for band in ((SLOW, HIGHEST), (LOWEST, SLOW)))
    return (*(quick[:2] or UNSEEN), *slow[:1])


def _highest(frequency: np.ndarray, excess: np.ndarray, band: tuple[float, float]) -> tuple[float, ...]:
    """The peaks within a band, the highest first, Hz."""
    peaks, _ = find_peaks(np.where((frequency > band[0]) & (frequency < band[1]), excess, 0.0))
    return tuple(float(frequency[peak]) for peak in sorted(peaks, key=lambda peak: -excess[peak]))


def _level(frequency: np.ndarray, density: np.ndarray) -> np.ndarray:
    """What a spectrum without a peak would have: the geometric mean half an octave below and above."""
    smooth = np.convolve(density, np.ones(5) / 5.0, mode="same")
    below, above = (np.interp(frequency * ratio, frequency, smooth) for ratio in (2.0**-0.5, 2.0**0.5))
    return np.asarray(np.sqrt(below * above))


def _spectra(
    sensor: Sensor, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Frequencies and density of each recording that the sensor is in."""
    name = sensor.instrument
    for run, recording in zip(motion, recordings, strict=False):
        group = recording.children[name].to_dataset(inherit=False) if name in recording.children else xr.Dataset()
        if "sensor" not in group.coords or sensor.name not in group["sensor"].values:
            continue
        quantity = load().observers[str(group.attrs["observer"])].quantity
        felt = {"acceleration": "acceleration", "force": "contact_force"}.get(quantity, "")
        if felt in run and group.sizes["time"] > 1:
            readings = group[quantity].sel(sensor=sensor.name).isel(axis=0).values
            body = str(group["sensor_body"].sel(sensor=sensor.name).values)
            times = group["time"].values
            moved = np.interp(times, run["time"].values, run[felt].sel(body=body).isel(axis=0).values)
            yield periodogram(np.nan_to_num(readings - moved), 1.0 / np.median(np.diff(times)), window="hann")
