"""Instruments against each other, by kinematics alone."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.locate.consistency import SIGNIFICANT, check_instruments
from crashkit.misfit.channel import groups_of
from crashkit.model import Model


@pytest.fixture
def checked(recorded, misfit, model):
    """The checks of two runs whose accelerometers were tampered with."""

    def check(change=lambda dataset: dataset, seed=0):
        runs = {f"run_{n}": recorded(model, speed, 10 * seed + n, accelerometer=change) for n, speed in enumerate((1.0, 1.3))}
        groups = misfit(model, **runs).groups
        return check_instruments({run: [group for group in groups if group.run == run] for run in runs})

    return check


def late(dataset, by=8):
    """The readings of `by` samples earlier, at rest before them."""
    values = dataset["acceleration"].values
    return dataset.assign(acceleration=(dataset["acceleration"].dims, np.concatenate([0.0 * values[:by], values[:-by]])))


@pytest.mark.parametrize("by", [4, 8, 40, 100])
def test_a_clock_that_is_late_by_much_leaves_nothing_once_it_is_put_right(checked, by):
    table = checked(lambda dataset: late(dataset, by)).set_coords("error").swap_dims(check="error").sel(error="clock_offset")
    assert float(table["estimate"]) == pytest.approx(by * 2.5e-4, abs=4.0 * float(table["std"]) + 2.5e-4)
    assert float(table["left"]) < 1.2


FAULTS = {
    "gain": (lambda d: d.assign(acceleration=1.05 * d["acceleration"]), 0.05),
    "bias": (lambda d: d.assign(acceleration=d["acceleration"] + 5.0), 5.0),
    "clock_offset": (late, 8 * 2.5e-4),
}


@pytest.mark.parametrize("error", FAULTS)
def test_a_fault_is_found_and_measured(checked, error):
    change, size = FAULTS[error]
    table = checked(change).set_coords("error").swap_dims(check="error")
    row = table.sel(error=error)
    assert float(row["estimate"]) == pytest.approx(size, abs=4.0 * float(row["std"]) + 0.05 * size)
    assert float(row["sigma"]) > SIGNIFICANT
    assert "inconsistent" in str(row["sentence"].values)
    assert str(row["place"].values) == "body front"


@pytest.mark.parametrize(
    ("factor", "asked"), [(1.0 / 9.80665, ": accelerations in g?"), (1e-3, ": positions in mm?"), (0.8, "")]
)
def test_a_unit_that_was_taken_for_another_is_asked_about(checked, factor, asked):
    table = checked(lambda d: d.assign(acceleration=factor * d["acceleration"])).set_coords("error").swap_dims(check="error")
    assert str(table["sentence"].sel(error="gain").values).endswith(f"){asked}")


@pytest.mark.parametrize("seed", range(4))
def test_perfect_instruments_agree(checked, seed):
    table = checked(seed=seed)
    assert table.sizes["check"] == 3
    assert table["sigma"].values.max() < 4.0
    assert all("inconsistent" not in sentence for sentence in table["sentence"].values)


def test_no_model_is_asked(checked, recorded, misfit, model):
    """However wrong the model, the check is the same."""
    runs = {"run": recorded(model)}
    wrong = model.with_values({"joint.first.crush_force": 1e4})
    first, second = (check_instruments({"run": list(misfit(m, **runs).groups)}) for m in (model, wrong))
    assert first.identical(second)


def test_one_instrument_alone_contradicts_nobody(recorded, misfit, model):
    run = recorded(model)
    del run["film"]
    table = check_instruments({"run": list(misfit(model, run=run).groups)})
    assert table.sizes["check"] == 0


def test_one_accelerometer_does_not_tell_how_a_body_turns_and_is_compared_with_nothing(watched_in_the_plane):
    """Nor is it an error: it takes part in everything else."""
    film, accelerometer = sorted(watched_in_the_plane, key=lambda group: group.observer.quantity, reverse=True)
    assert film.motion() is not None and accelerometer.motion() is None
    assert check_instruments({"run": watched_in_the_plane}).sizes["check"] == 0


def test_in_the_plane_they_are_compared_where_the_body_is_accelerated_most(workshop, misfit, model, recorded):
    """The first axis of the instruments is one in which nothing happens."""
    run = recorded(model)
    plane = {name: across(run[name].to_dataset(inherit=False)) for name in ("film", "accelerometer")}
    bodies = tuple(evolve(body, position=(0.0, *body.position), velocity=(0.0, *body.velocity)) for body in model.bodies)
    groups = groups_of("run", xr.DataTree.from_dict(plane), workshop.observers, Model("plane", ("x", "y"), bodies, ()))
    table, expected = (check_instruments({"run": list(some)}) for some in (groups, misfit(model, run=run).groups))
    assert table["estimate"].values == pytest.approx(expected["estimate"].values)
    assert table["std"].values == pytest.approx(expected["std"].values)
    assert str(table["sentence"].values[0]).startswith("accelerometer against film on front along y: ")


def across(instrument):
    """What is recorded along x as if it were along y, and nothing along x."""
    along = instrument.assign_coords(axis=["y"])
    quantity = "position" if "position" in along else "acceleration"
    still = instrument.assign({quantity: 0.0 * instrument[quantity]})
    return xr.concat([still, along], dim="axis", data_vars="minimal", combine_attrs="override")
