"""Accelerations that jump where a contact begins or ends."""

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit.protocols import Smoother
from crashkit.testing.smoother_contract import channel, noisy, rms, stop
from crashkit_smoothers import AdaptiveQuintic, GcvHeptic, GcvQuintic

TIMES = np.arange(200) * 1e-3 + 0.0005
BEGIN, END, BRAKE = 0.05, 0.13, 200.0  # s, s, m s-2
APART = np.minimum(np.abs(TIMES - BEGIN), np.abs(TIMES - END)) > 2e-3


def braked() -> tuple[np.ndarray, np.ndarray]:
    """Position and acceleration of a body that is braked evenly from BEGIN to END."""
    during = np.clip(TIMES - BEGIN, 0.0, END - BEGIN)
    after = np.maximum(TIMES - END, 0.0)
    position = 14.0 * TIMES - BRAKE * during**2 / 2.0 - BRAKE * (END - BEGIN) * after
    return position, np.where((TIMES > BEGIN) & (TIMES < END), -BRAKE, 0.0)


@pytest.mark.parametrize("kind", [GcvQuintic, GcvHeptic, AdaptiveQuintic])
def test_given_contacts_let_the_acceleration_jump(kind: type[Smoother]) -> None:
    position, acceleration = braked()
    errors = []
    for draw in range(10):
        samples = channel(TIMES, noisy(position, draw))
        with_them, without = (
            smoother.smooth(samples)["second_derivative"].values for smoother in (kind(contacts=(END, BEGIN)), kind())
        )
        errors.append([rms((curve - acceleration)[APART]) for curve in (with_them, without)])
    known, unknown = np.median(errors, axis=0)
    assert known < 0.35 * unknown


def test_value_and_velocity_stay_continuous() -> None:
    position, _ = braked()
    times = np.sort(np.concatenate([TIMES, [BEGIN - 1e-9, BEGIN + 1e-9]]))
    samples = np.interp(times, TIMES, noisy(position, 1))
    samples[np.isin(times, TIMES, invert=True)] = np.nan
    smooth = AdaptiveQuintic(contacts=(BEGIN, END)).smooth(channel(times, samples))
    place = np.searchsorted(times, BEGIN)
    jump = smooth.isel(time=place) - smooth.isel(time=place - 1)
    assert abs(jump["value"]) < 1e-6
    assert abs(jump["first_derivative"]) < 1e-3
    assert jump["second_derivative"] == pytest.approx(-BRAKE, rel=0.2)


def test_contacts_are_found() -> None:
    position, acceleration = braked()
    found = []
    for draw in range(6):
        smooth = AdaptiveQuintic(find_contacts=True).smooth(channel(TIMES, noisy(position, draw)))
        contacts = smooth.attrs.get("contacts", [])
        error = rms((smooth["second_derivative"].values - acceleration)[APART])
        found.append(len(contacts) == 2 and np.allclose(contacts, [BEGIN, END], atol=2e-3) and error < 12.0)
    assert sum(found) >= 5


def test_a_smooth_motion_has_no_contacts() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 200))
    for draw in range(6):
        smooth = AdaptiveQuintic(find_contacts=True).smooth(channel(times, noisy(truth[0], draw)))
        assert "contacts" not in smooth.attrs


@pytest.mark.parametrize("contacts", [(0.3,), (-0.01,), (0.05, 0.0502), (0.0006,)])
def test_contacts_without_room_are_refused(contacts: tuple[float, ...]) -> None:
    with pytest.raises(
        CrashkitError, match="gcv_quintic: expected contacts with at least 3 samples before, between and after"
    ):
        GcvQuintic(contacts=contacts).smooth(channel(TIMES, braked()[0]))


def test_a_given_contact_stays_while_others_are_found() -> None:
    smooth = AdaptiveQuintic(contacts=(0.0512,), find_contacts=True).smooth(channel(TIMES, noisy(braked()[0], 2)))
    assert smooth.attrs["contacts"][0] == pytest.approx(0.0512, abs=1e-9)
    assert smooth.attrs["contacts"][-1] == pytest.approx(END, abs=2e-3)
