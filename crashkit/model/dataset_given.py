"""Given motions and forces of a model's Dataset: one table of samples for each, with the body that each sample belongs to."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crashkit.model.given import GivenForce, GivenMotion, Rows
from crashkit.model.model import Model
from crashkit.model.pose import ORIENTATION, ROTATION


def motions_to_columns(model: Model) -> dict[str, np.ndarray]:
    """The variables `motion_*`, those of them that the model needs."""
    given = [(body.name, m.time, m.position, m.orientation) for body in model.bodies if (m := body.motion) is not None]
    return _columns(given, ("motion_body", "motion_time", "motion_position", "motion_orientation"), model, ORIENTATION)


def forces_to_columns(model: Model) -> dict[str, np.ndarray]:
    """The variables `force_*`, those of them that the model needs."""
    given = [(body.name, f.time, f.force, f.moment) for body in model.bodies if (f := body.force) is not None]
    return _columns(given, ("force_body", "force_time", "force_force", "force_moment"), model, ROTATION)


def given_motion(columns: Mapping[str, list[Any]], body: str) -> GivenMotion | None:
    """The given motion of a body; None where it has none."""
    found = _samples(columns, ("motion_body", "motion_time", "motion_position", "motion_orientation"), body)
    return GivenMotion(*found) if found else None


def given_force(columns: Mapping[str, list[Any]], body: str) -> GivenForce | None:
    """The given force on a body; None where there is none."""
    found = _samples(columns, ("force_body", "force_time", "force_force", "force_moment"), body)
    return GivenForce(*found) if found else None


def _columns(
    given: Sequence[tuple[str, Sequence[float], Rows, Rows]],
    names: tuple[str, str, str, str],
    model: Model,
    turning: Mapping[int, int],
) -> dict[str, np.ndarray]:
    if not given:
        return {}
    axes = len(model.axes)
    missing = (np.nan,) * turning[axes]
    second = [row for _, time, _, rows in given for row in (rows or (missing,) * len(time))]
    columns = {
        names[0]: np.array([body for body, time, *_ in given for _ in time], dtype=str),
        names[1]: np.array([instant for _, time, *_ in given for instant in time], dtype=float),
        names[2]: np.array([row for _, _, rows, _ in given for row in rows], dtype=float).reshape(-1, axes),
    }
    if any(rows for *_, rows in given):
        columns[names[3]] = np.array(second, dtype=float)
    return columns


def _samples(
    columns: Mapping[str, list[Any]], names: tuple[str, str, str, str], body: str
) -> tuple[tuple[float, ...], Rows, Rows] | None:
    own = [index for index, name in enumerate(columns.get(names[0], [])) if name == body]
    if not own:
        return None
    time, first, second = ([columns[name][index] for index in own] if name in columns else [] for name in names[1:])
    return tuple(time), tuple(map(tuple, first)), () if np.isnan(second).all() else tuple(map(tuple, second))
