"""Load cells: the force that a body, usually the obstacle, receives from the joints."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.data.instrument_errors import CLOCK_ERRORS
from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import CHANNEL_FREQUENCY_CLASS
from crashkit.errors import CrashkitError
from crashkit.protocols import Misread, PlainObserver, Reading, SensorErrors, Shown
from crashkit_accelerometers.error_specs import channel_errors
from crashkit_accelerometers.sensor_channel import (
    DIMS,
    bodies_of,
    felt_in_laboratory,
    misread_channels,
    own_errors,
    plain_reading,
    predict_channels,
    reconstruct_bodies,
)


class LoadCell(PlainObserver):
    """A load cell takes the whole force of the joints on its body, and records it with its own errors."""

    name = "load_cell"
    schema = GroupSchema(
        "load_cell",
        (
            Variable(
                "force",
                DIMS,
                "N",
                "the force that the body receives, in the laboratory frame",
                allow_nan=True,
                allow_silent=True,
            ),
            Variable("sensor_body", ("sensor",), None, "the body that receives the force", kind="text"),
            Variable(
                "force_std", ("sensor",), "N", "standard deviation of a sample as recorded", required=False, positive=True
            ),
        ),
        (CHANNEL_FREQUENCY_CLASS,),
    )
    quantity = "force"
    channel = "sensor"
    errors = channel_errors("N", full_scale=1e6)
    instrument_errors = CLOCK_ERRORS

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: SensorErrors | None = None) -> xr.Dataset:
        """The force on each cell's body, as `Observer.predict` says; needs `contact_force` (time, body, axis) of the motion.

        Joints that support a body are not felt.

        Raises CrashkitError where several cells share a body: how they share its force is not known.
        """
        _refuse_shared_bodies(instrument)
        felt = felt_in_laboratory(self, _without_supports(motion), "contact_force", bodies_of(self, motion, instrument))
        return predict_channels(self, motion, instrument, own_errors(self, instrument, errors), felt)

    def reading(self, instrument: xr.Dataset, turning: bool) -> Reading | None:
        """The forces of the joints on the bodies."""
        _refuse_shared_bodies(instrument)
        return plain_reading(instrument, "contact_force")

    def misread(self, shown: Shown, instrument: xr.Dataset, errors: SensorErrors, wanted: Sequence[str]) -> Misread:
        """As `PlainObserver.misread` says."""
        return misread_channels(self, shown, instrument, errors, wanted)

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        """The force that each body receives, `contact_force` (time, body, axis).

        Raises CrashkitError where several cells share a body.
        """
        _refuse_shared_bodies(instrument)
        return reconstruct_bodies(self, instrument, "contact_force")


def _without_supports(motion: xr.Dataset) -> xr.Dataset:
    """The motion with the net force of only those joints on each body that do not support one; on a line."""
    if "joint_support" not in motion.variables or not motion.variables["joint_support"].values.any():
        return motion
    if "joint_side" not in motion.variables:
        raise CrashkitError("load_cell: expected a motion with joint_side, as some joint supports a body, found none")
    bodies, sides = motion.variables["body"].values.tolist(), motion.variables["joint_side"].values
    names = [name for name in ("contact_force", "contact_force_sensitivity") if name in motion.variables]
    felt = {name: motion.variables[name].copy() for name in names}
    for joint in np.flatnonzero(motion.variables["joint_support"].values):
        first, second = (bodies.index(name) for name in motion.variables["joint_bodies"].values[joint].tolist())
        for name, variable in felt.items():
            force = sides[joint] * motion.variables[name.replace("contact_force", "force")].values[:, joint]
            variable.values[:, first, 0] += force
            variable.values[:, second, 0] -= force
    return motion.assign(felt)


def _refuse_shared_bodies(instrument: xr.Dataset) -> None:
    bodies = instrument.variables["sensor_body"].values.tolist()
    shared = sorted({body for body in bodies if bodies.count(body) > 1})
    if shared:
        raise CrashkitError(
            f"load_cell: expected one sensor for each body, found several on {', '.join(shared)}: sum them into one channel"
        )
