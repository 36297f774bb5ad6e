"""What the smoothers do beyond one noisy record: units of time, filtered channels, contacts, and what their bands hold."""

import numpy as np

from benchmarks import Row
from benchmarks.smoothing.peers import NAMES, scipy_spline
from benchmarks.smoothing.pulses import CONTACTS, PULSES, Recorded, accelerometer, blow, even, film, half_sine, rippled
from crashkit.protocols import Smoother
from crashkit_smoothers import AdaptiveQuintic, GcvQuintic, Spectral

DRAWS = 20
WITHIN_TWO = 0.954
"""Share of a normal distribution within two standard deviations."""
AWAY = 2e-3
"""s, from a jump of the acceleration, where it has one value."""


def run() -> list[Row]:
    """Rows of each kind."""
    return [*_units(), *_filtered(), *_contacts(), *_bands()]


def _units() -> list[Row]:
    """By how much the acceleration changes when time is not in ms."""
    draw, rows = film(half_sine, even(200), 0), []
    for name, unit in (("s", 1.0), ("us", 1e6)):
        mine = _rms(_in_unit(draw, unit) - _in_unit(draw, 1e3))
        theirs = _rms(scipy_spline(draw, unit)[2] - scipy_spline(draw)[2])
        rows.append(Row(f"time in {name} for ms: change of a", "error", "m s-2", mine, "scipy make_smoothing_spline", theirs))
    return rows


def _in_unit(draw: Recorded, unit: float) -> np.ndarray:
    smooth = AdaptiveQuintic().smooth(draw.channel.assign_coords(time=draw.times * unit))
    return smooth["second_derivative"].values * unit**2


def _filtered() -> list[Row]:
    """An accelerometer's channel: what is left of the noise, and the noise that is found; the peer is the channel itself."""
    rows = []
    for cfc in (60, 180, 600):
        for smoother in (AdaptiveQuintic(), Spectral()):
            left, found, noise = [], [], []
            for draw in range(DRAWS):
                recorded = accelerometer(rippled, cfc, draw, 20.0)
                smooth = smoother.smooth(recorded.channel.assign_attrs(channel_frequency_class=cfc))
                left.append(_rms(smooth["value"].values - recorded.truth[0]))
                found.append(smooth.attrs["noise_std"])
                noise.append(recorded.noise)
            case, level = f"CFC{cfc}, {smoother.name}", float(np.median(noise))
            rows.append(Row(f"{case}: error", "error", "m s-2", float(np.median(left)), "as recorded", level))
            rows.append(Row(f"{case}: noise found", "error", "m s-2", float(np.median(found)), "true noise", level))
    return rows


def _contacts() -> list[Row]:
    """A rectangle of acceleration: with its contacts known or found, against none."""
    draws = [film(blow, even(200), draw) for draw in range(DRAWS)]
    away = np.min([np.abs(draws[0].times - contact) for contact in CONTACTS], axis=0) > AWAY
    without, known, found = (
        float(np.median([_rms((_acceleration(smoother, draw) - draw.truth[2])[away]) for draw in draws]))
        for smoother in (AdaptiveQuintic(), AdaptiveQuintic(contacts=CONTACTS), AdaptiveQuintic(find_contacts=True))
    )
    return [
        Row("rectangle, contacts known: a", "error", "m s-2", known, "without", without),
        Row("rectangle, contacts found: a", "error", "m s-2", found, "without", without),
    ]


def _bands() -> list[Row]:
    """The share of samples whose band of two standard deviations holds the truth, over all pulses and draws."""
    rows = []
    for smoother in (AdaptiveQuintic(), GcvQuintic(), Spectral()):
        held = {pulse: _held(smoother, pulse) for pulse in PULSES}
        for index, name in enumerate(("x", "v", "a")):
            shares = [share[index] for share in held.values()]
            for label, share in (("mean of pulses", float(np.mean(shares))), ("least of pulses", min(shares))):
                rows.append(Row(f"bands of {name}, {smoother.name}, {label}", "rate", "1", share, "normal", WITHIN_TWO))
    return rows


def _held(smoother: Smoother, pulse: str) -> list[float]:
    held = []
    for draw in range(DRAWS):
        recorded = film(PULSES[pulse], even(200), draw)
        smooth = smoother.smooth(recorded.channel)
        held.append(
            [
                np.mean(np.abs(smooth[name].values - truth) < 2.0 * smooth[f"{name}_std"].values)
                for name, truth in zip(NAMES, recorded.truth, strict=True)
            ]
        )
    return np.mean(held, axis=0).tolist()


def _acceleration(smoother: Smoother, draw: Recorded) -> np.ndarray:
    return smoother.smooth(draw.channel)["second_derivative"].values


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))
