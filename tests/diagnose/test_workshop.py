"""One engine for every model that a diagnosis tries, and recordings that a search can look at quickly."""

import numpy as np
import pytest
import xarray as xr

from crashkit.data.channel_filter import filter_channel
from crashkit.mechanics import Simulator
from crashkit.testing import toys


def test_the_engine_holds_the_laws_of_all_claims_before_any_is_made(workshop):
    """Among them those of a contact, which only bodies that come nearer to each other ask for."""
    laws = {function.law.name for function in workshop.engine.numbers}
    assert {"crush_stop", "dahl", "maxwell", "coulomb", "crush_plateau + folding", "viscous_power"} <= laws


@pytest.mark.parametrize("cfc", [0, 180, 1000])
def test_what_a_fitted_model_explains_is_thinned_without_error(workshop, cfc):
    """Corners, and what a filter makes of them at a low rate, are not taken for physics."""
    model = toys.one_degree()
    model = model.with_values({p: 30.0 * v.value for p, v in model.parameters().items() if p.endswith("stiffness")})
    times = np.arange(3001) * 1e-4
    motion = Simulator(model, workshop.laws, workshop.engine).run(times, initial=toys.initial_state(model, 1.0), step=1e-4)
    run = toys.recording(motion)
    felt = run["accelerometer"].to_dataset(inherit=False)
    if cfc:
        filtered = filter_channel(felt["acceleration"].values, times, cfc, before=0.0)
        felt = felt.assign(acceleration=felt["acceleration"].copy(data=filtered)).assign_attrs(channel_frequency_class=cfc)
    recordings = {"run": run.assign(accelerometer=xr.DataTree(felt))}
    left = {}
    for name, fitted in (("as it is", None), ("in the light of the model", model)):
        misfit = workshop.first_misfit(model, workshop.thinned(recordings, fitted))
        left[name] = np.abs(misfit.residual(misfit.start())).max()
    assert left["as it is"] > 0.1
    assert left["in the light of the model"] < 0.02
