"""An ensemble: one model at many values."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor

import xarray as xr
from numpy.typing import ArrayLike

from crashkit.mechanics import Simulator


def ensemble(
    simulator: Simulator, values: Sequence[Mapping[str, float]], times: ArrayLike, executor: Executor | None = None
) -> xr.Dataset:
    """The motions of one model at many values, along a first dim `member`.

    Arguments:
        simulator: of the model.
        values: by path, one mapping for each member, as `Simulator.run` takes them.
        times: s, as `Simulator.run` takes them.
        executor: who simulates; None: this thread. A pool of threads uses all cores: the engine runs without Python's lock.

    Raises:
        CrashkitError: as `Simulator.run` does, for the first member that fails.
    """

    def motion(one: Mapping[str, float]) -> xr.Dataset:
        return simulator.run(times, one)

    motions = list(map(motion, values) if executor is None else executor.map(motion, values))
    return xr.concat(motions, dim="member", coords="minimal", compat="override", join="override")
