"""Targets followed through rendered films: to what accuracy, lost and found again, and shown anew by a user."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit_cameras.tracking import Frame, Imaging, Painted, Pose, detect, follow, mark, render, true_position

TIMES = np.arange(12) * 1e-3
RADIUS = 8.0


def on_its_way(u: float, v: float, speed: float = 1500.0, angle: float = 0.3) -> Callable[[float], Pose]:
    """A target that moves by 1.5 pixel from frame to frame, and falls back."""
    return lambda time: Pose((u + speed * time - 4e4 * time**2, v + 300.0 * time), RADIUS, angle + 20.0 * time)


TARGETS = [Painted("sill", "quadrant", on_its_way(30.0, 28.0)), Painted("roof", "quadrant", on_its_way(52.0, 62.0, 800.0))]
SHOWN = {"sill": (31.0, 27.0), "roof": (51.0, 63.0)}


def film(targets: Sequence[Painted] = TARGETS, times: np.ndarray = TIMES, **imaging: float) -> list[Frame]:
    return render(targets, Imaging(96, 90, **{"noise": 2.0, "ground": 0.4, **imaging}), times)  # type: ignore[arg-type]


def test_targets_are_followed_to_two_hundredths_of_a_pixel_and_it_is_told() -> None:
    found = follow(film(noise=4.0), mark(SHOWN))
    errors = found["image_position"] - true_position(TARGETS, TIMES)
    assert float((errors**2).mean() ** 0.5) < 0.02
    assert 0.7 < float(((errors / found["image_position_std"]) ** 2).mean() ** 0.5) < 1.35
    assert (found["lost"] == "").all()
    assert found["quality"].min() > 0.9


def test_a_film_can_be_followed_backward() -> None:
    ends = true_position(TARGETS, TIMES[-1:])[0]
    shown = {name: tuple(ends.sel(marker=name).values + 1.0) for name in SHOWN}
    found = follow(reversed(film()), mark(shown))
    assert found["time"].values.tolist() == TIMES.tolist()
    assert abs(found["image_position"] - true_position(TARGETS, TIMES)).max() < 0.05


def test_a_target_that_something_hides_is_lost_and_found_again() -> None:
    """A card passes in front of the sill's target from the fifth to the eighth frame."""
    card = Painted("card", "card", lambda time: Pose((38.0, 29.0 if 0.0035 < time < 0.0075 else -90.0), 12.0), dark=0.3)
    found = follow(film([*TARGETS, card]), mark(SHOWN)).sel(marker="sill")
    hidden = found["lost"].values != ""
    assert hidden[4:8].all() and not hidden[:4].any() and not hidden[9:].any()
    assert np.isnan(found["image_position"][hidden]).all()
    seen = found["image_position"][~hidden] - true_position(TARGETS, TIMES).sel(marker="sill")[~hidden]
    assert abs(seen).max() < 0.05


def test_light_that_changes_from_one_frame_to_the_next_does_no_harm() -> None:
    """The gradient of the light is remembered, but a lamp that goes on is another light."""
    dark, lit = film(times=TIMES[:6]), film(times=TIMES[6:], light=(0.01, -0.005))  # type: ignore[arg-type]
    found = follow([*dark, *lit], mark(SHOWN))
    assert abs(found["image_position"] - true_position(TARGETS, TIMES)).max() < 0.04


def test_a_correction_shows_a_target_later_in_the_film() -> None:
    later = true_position(TARGETS, [TIMES[6]])[0].sel(marker="roof").values
    shown = mark({"roof": (later[0] - 1.0, later[1] + 1.0)}, time=TIMES[6])
    found = follow(film(), mark({"sill": SHOWN["sill"]}), shown)
    assert found["lost"].sel(marker="roof").values[:6].tolist() == ["not shown yet"] * 6
    errors = (found["image_position"] - true_position(TARGETS, TIMES)).sel(marker="roof")[6:]
    assert abs(errors).max() < 0.05


def test_detection_proposes_the_targets_of_an_image() -> None:
    found = detect(film()[0].image, radius=(5.0, 12.0))
    assert found.sizes["marker"] == 2
    places = true_position(TARGETS, TIMES[:1])[0].values
    distance = np.linalg.norm(found["image_position"].values[:, None] - places, axis=2)
    assert distance.min(axis=0).max() < 0.05
    np.testing.assert_allclose(found["radius"], RADIUS, rtol=0.15)


def test_an_image_without_targets_has_none() -> None:
    assert detect(film([])[0].image).sizes["marker"] == 0


def test_what_cannot_be_followed_is_refused() -> None:
    with pytest.raises(CrashkitError, match="start: expected a target where roof was shown, found none"):
        follow(film(TARGETS[:1]), mark(SHOWN))
    with pytest.raises(CrashkitError, match="film: expected at least one frame, found none"):
        follow([], mark(SHOWN))
    with pytest.raises(CrashkitError, match="correction: expected the time of a frame, found 0.5 s"):
        follow(film()[:2], mark(SHOWN), mark({"boot": (20.0, 20.0)}, time=0.5))
    with pytest.raises(CrashkitError, match="kind of target: expected one of quadrant, dot, found 'cross'"):
        mark(SHOWN, "cross")
    colour = Frame(0.0, np.zeros((20, 20, 3), dtype=np.uint8))
    with pytest.raises(CrashkitError, match=r"frame at 0 s: expected a grey image \(row, column\), found shape \(20, 20, 3\)"):
        follow([colour], mark(SHOWN))
