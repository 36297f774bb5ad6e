"""Every example file is read, written, and simulated; mechanics holds in all of them."""

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from crashkit.cli import main
from crashkit.data.motion import read_motion
from crashkit.data.schemas import MOTION
from crashkit.data.validate import faults_of
from crashkit.model import Model
from crashkit.model.dataset import model_from_dataset, model_to_dataset
from crashkit.model.toml import read_model, write_model
from crashkit.registry import load


def test_survives_both_round_trips(tmp_path, example, model_of):
    model = model_of(example)
    write_model(model, tmp_path / "again.toml", load().spring_laws)
    assert read_model(tmp_path / "again.toml", load().spring_laws) == model
    assert model_from_dataset(model_to_dataset(model)) == model


def test_its_motion_keeps_the_contract(example, motion_of):
    motion = motion_of(example)
    assert not faults_of(motion, MOTION)
    assert all(np.isfinite(variable.values).all() for variable in motion.data_vars.values())


def test_its_command_names_it(example, command_of):
    assert command_of(example)[:3] == ["crashkit", "simulate", f"docs/examples/{example}.toml"]
    assert command_of(example)[-2:] == ["--output", "motion.nc"]


def test_a_command_works(tmp_path, monkeypatch, examples, command_of):
    monkeypatch.chdir(tmp_path)
    options = command_of("obstacles/rigid_barrier")[3:]
    assert main(["simulate", str(examples / "obstacles" / "rigid_barrier.toml"), *options]) == 0
    assert read_motion(tmp_path / "motion.nc")["time"].values[-1] == 0.12


def test_is_checked_by_the_command_line(example, examples, capsys):
    assert main(["check", str(examples / f"{example}.toml")]) == 0
    assert "as it should be" in capsys.readouterr().out


def test_momentum_changes_by_the_forces_from_outside(example, model_of, motion_of):
    """m v(t) - m v(0), summed over the free bodies, is the impulse of gravity and of the bodies that no force moves."""
    model, motion = model_of(example), motion_of(example)
    free, held = _free(model), [body.name for body in model.bodies if body.name not in _free(model)]
    masses = xr.DataArray([model.body(name).mass.value for name in free], dims="body", coords={"body": free})
    momentum = (masses * motion["velocity"].sel(body=free)).sum("body")
    outside = -motion["contact_force"].sel(body=held).sum("body") + float(masses.sum()) * _gravity(model)
    impulse = outside.cumulative_integrate("time")
    scale = float(abs(masses * motion["velocity"].sel(body=free)).max())
    assert float(abs(momentum - momentum.isel(time=0) - impulse).max()) < 2e-3 * scale


def test_energy_goes_into_the_joints(example, model_of, motion_of):
    """Kinetic and potential energy of the free bodies is that at t = 0, what driven bodies added, and what joints took."""
    model, motion = model_of(example), motion_of(example)
    energy = _energy(model, motion)
    absorbed = (motion["force"] * motion["deformation_rate"]).sum("joint").cumulative_integrate("time")
    added = -_power_of_driven_bodies(model, motion).cumulative_integrate("time")
    scale = float(energy.max())
    assert float(abs(energy + absorbed - energy.isel(time=0) - added).max()) < 3e-3 * scale


def test_no_joint_gives_out_more_than_it_took_in(example, motion_of):
    """Of a joint that is compressed at t = 0, as a seat is, it took in what compressed it."""
    motion = motion_of(example)
    held = 0.5 * (motion["force"] * motion["deformation"]).isel(time=0)
    taken = held + (motion["force"] * motion["deformation_rate"]).cumulative_integrate("time")
    assert float(taken.min()) > -1e-3 * float(taken.max())


def _free(model: Model) -> list[str]:
    return [body.name for body in model.bodies if not body.fixed and body.motion is None]


def _gravity(model: Model) -> xr.DataArray:
    return xr.DataArray(_in_space(model.gravity or (0.0,) * len(model.axes), model), dims="axis")


def _in_space(vector: tuple[float, ...], model: Model) -> np.ndarray:
    space = np.zeros(3)
    space[["xyz".index(axis) for axis in model.axes]] = vector
    return space


def _energy(model: Model, motion: xr.Dataset) -> xr.DataArray:
    total = xr.zeros_like(motion["time"], dtype=float)
    for name in _free(model):
        body, own = model.body(name), motion.sel(body=name)
        spin = own["angular_velocity"].values
        if len(model.axes) == 3:
            spin = Rotation.from_quat(own["orientation"].values, scalar_first=True).inv().apply(spin)
            turning = 0.5 * spin**2 @ [entry.value for entry in body.inertia]
        else:
            turning = 0.5 * body.inertia[0].value * (spin**2).sum(axis=1)
        straight = 0.5 * (own["velocity"] ** 2).sum("axis") - (own["position"] * _gravity(model)).sum("axis")
        total = total + body.mass.value * straight + turning
    return total


def _power_of_driven_bodies(model: Model, motion: xr.Dataset) -> xr.DataArray:
    """Of the joints on bodies whose motion is given; they move without turning in the examples."""
    driven = [body.name for body in model.bodies if body.motion is not None]
    own = motion.sel(body=driven)
    return (own["contact_force"] * own["velocity"]).sum(["body", "axis"])
