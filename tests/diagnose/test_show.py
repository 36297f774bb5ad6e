"""The tables behind a diagnosis."""

import xarray as xr

from crashkit.diagnose.show import units_of
from crashkit.model import Parameter
from crashkit.model.edit import with_instrument_error


def test_the_offset_of_a_load_cell_is_a_force(workshop, model, recorded, misfit):
    """And that of an accelerometer an acceleration, though both are called bias."""
    run = recorded(model)
    felt = run["accelerometer"].to_dataset(inherit=False)
    cell = felt.rename(acceleration="force", acceleration_std="force_std").assign_attrs(observer="load_cell")
    run = run.assign(plate=xr.DataTree(cell))
    for instrument in ("accelerometer", "plate"):
        model = with_instrument_error(model, instrument, "front_sensor", "bias", Parameter(0.0))
    units = units_of(model, misfit(model, run=run).groups, workshop)
    assert units["instrument.plate.front_sensor.bias"] == "N"
    assert units["instrument.accelerometer.front_sensor.bias"] == "m s-2"
