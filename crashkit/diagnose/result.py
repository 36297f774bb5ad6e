"""What a diagnosis says: for programs (diagnosis.json), for people (the text and the page)."""

import math
from collections.abc import Mapping
from pathlib import PurePath

import xarray as xr
from attrs import field, frozen

from crashkit.model import Model

UNKNOWN = "unknown"
"""The physics of a force that no list has."""


@frozen
class Estimate:
    """An identified number with its standard deviation, in `units`.

    Attributes:
        identifiable: whether the recordings see the number by itself; if not, it is one of many that fit equally well.
    """

    value: float
    std: float
    units: str
    identifiable: bool = True


IN_WORDS = 0.01
"""Probability from which a rival is told in words, not only listed."""


@frozen
class Alternative:
    """A rival explanation of the same misfit."""

    physics: str
    form: str
    location: Mapping[str, object]
    probability: float


@frozen
class Finding:
    """One piece of physics that the model or an instrument's description left out.

    Attributes:
        physics, form: its name and its functional form.
        sentence: what it is and where, for people.
        probability: of this physics at this place, among everything that was tried.
        location: one of joint, body, bodies, sensor, instrument.
        runs: recordings in which it shows.
        time: s, from when to when it acts.
        phase: "loading", "unloading" or "both".
        parameters: of the new physics, by name.
        alternatives: rivals, the most probable first.
        experiment: which test would separate the rivals, if any are left.
    """

    physics: str
    form: str
    sentence: str
    probability: float
    location: Mapping[str, object]
    runs: tuple[str, ...]
    time: tuple[float, float]
    phase: str
    parameters: Mapping[str, Estimate]
    alternatives: tuple[Alternative, ...] = field(default=())
    experiment: str = ""

    @property
    def anywhere(self) -> float:
        """The probability of this physics, here or where a rival puts it."""
        return self.probability + sum(one.probability for one in self.alternatives if one.physics == self.physics)

    @property
    def is_split(self) -> bool:
        """Whether rivals put the same physics at other places, with a probability that is told in words."""
        return self.anywhere > self.probability + IN_WORDS


@frozen
class Fit:
    """How well a model predicts a set of runs.

    Attributes:
        normalised_rmse: root mean square of residual over its standard deviation, over all channels; 1 is the noise floor.
        channels: Dataset over `channel` ("run/instrument/sensor") with `normalised_rmse`, `relative_rmse` (of the signal),
            `rating` (ISO/TS 18571), `independent_samples`.
        expected_rmse: what the right model would leave in runs that it was not fitted to, where that was asked.
        untold: the number that makes it so much, by path.
        together_rmse: what the model leaves in all runs once it is fitted to these as well, where that was asked.
    """

    normalised_rmse: float
    channels: xr.Dataset
    expected_rmse: float = math.nan
    untold: str = ""
    together_rmse: float = math.nan


@frozen(repr=False)
class Diagnosis:
    """The answer to: do simulation and recording differ, where, why, and does modelling it help.

    Attributes:
        verdict: "consistent", "missing_physics", "sensor_fault" or "unexplained".
        summary: about ten lines for people.
        findings: what was found, the most certain first.
        base_model: the given model, re-identified.
        augmented_model: with the physics that was found.
        fits: by set of runs ("calibration", "holdout") and model ("before", "after").
        curves: one group per "run/instrument" with `recorded`, `before`, `after` and `std` over (time, channel), the
            attributes `holdout` (0/1), `quantity` and `units`.
        missing_force: one group per finding ("0", "1", ...) and run below it, over `time`: `missing_force` (N, from the
            recorded accelerations by inverse dynamics along the fitted motion, in the direction of the joint),
            `missing_force_std`, `modelled_force` (what the finding adds), `deformation`, `deformation_rate`; attributes
            `place`, `holdout`. Empty for sensors.
        ranking: Dataset over `hypothesis` with `physics`, `form`, `place`, `round` (1 for the first finding, ...),
            `parameters` (how many), `misfit_drop` (in chi squared), `left_out_drop` (on runs left out; NaN if not tried),
            `probability`.
        consistency: Dataset over `check` with `sentence`, `sigma` and `place`: instruments compared by kinematics alone.
        identified: Dataset over `parameter` of the augmented model: `value`, `std`, `units`, `identifiable`, `before`.
        notes: what cannot be trusted, and why.
        time_up: s, the limit after which no further question was asked; None: all were.
        detectable: Dataset over `effect` with `physics`, `form`, `place`, `parameter`, `smallest` and `units`: how large what
            was not found would have had to be to be found.
    """

    verdict: str
    summary: str
    findings: tuple[Finding, ...]
    base_model: Model
    augmented_model: Model
    fits: Mapping[str, Mapping[str, Fit]]
    curves: xr.DataTree
    missing_force: xr.DataTree
    ranking: xr.Dataset
    consistency: xr.Dataset
    identified: xr.Dataset
    notes: tuple[str, ...] = field(default=())
    detectable: xr.Dataset = field(factory=xr.Dataset)
    time_up: float | None = field(default=None)

    def __repr__(self) -> str:
        return f"diagnosis: {self.verdict}\n{self.summary}"


def place_of(location: Mapping[str, object]) -> str:
    """A location in words: {"joint": "front"} gives "joint front"."""
    kind = next(key for key in ("joint", "bodies", "body", "sensor", "instrument") if key in location)
    value = location[kind]
    names = " and ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
    return f"{kind} {names}"


def own_name(path: str) -> str:
    """What a parameter is called where it is: `joint.front.crush_force` gives `crush_force`."""
    return path.rsplit(".", 1)[-1]


def run_name(path: PurePath | str) -> str:
    """The name of a run in results: its file name."""
    return PurePath(path).name
