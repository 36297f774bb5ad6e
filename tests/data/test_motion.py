import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings

from crashkit.data import read_motion, write_motion
from crashkit.errors import ContractError, CrashkitError
from crashkit.testing.strategies import motions


@pytest.fixture
def motion() -> xr.Dataset:
    return xr.Dataset(
        {
            "position": (("time", "body", "axis"), np.arange(4.0).reshape(2, 2, 1), {"units": "m"}),
            "force": (("time", "joint"), np.ones((2, 1)), {"units": "N"}),
            "joint_bodies": (("joint", "end"), [["barrier", "engine"]]),
        },
        {"time": ("time", [0.0, 0.1], {"units": "s"}), "body": ["barrier", "engine"], "axis": ["x"], "joint": ["front"]},
    )


def test_written_and_read_is_identical(tmp_path, motion):
    write_motion(motion, tmp_path / "motion.nc")
    assert read_motion(tmp_path / "motion.nc").identical(motion)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(motions())
def test_any_motion_written_and_read_is_identical(tmp_path_factory, motion):
    path = tmp_path_factory.mktemp("motion") / "motion.nc"
    write_motion(motion, path)
    assert read_motion(path).identical(motion)


def test_a_motion_that_breaks_the_contract_is_not_written(tmp_path, motion):
    motion["force"].attrs["units"] = "kN"
    with pytest.raises(ContractError, match=r'motion.nc: motion/force: expected units "N", found "kN"$'):
        write_motion(motion, tmp_path / "motion.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_no_motion_is_refused(tmp_path, motion):
    motion[["joint_bodies"]].to_netcdf(tmp_path / "motion.nc")
    with pytest.raises(
        ContractError, match=r"motion.nc: motion: expected at least one of position, velocity, .*, found none$"
    ):
        read_motion(tmp_path / "motion.nc")


def test_no_such_file(tmp_path):
    with pytest.raises(CrashkitError, match=r"none.nc: expected a netCDF file, found no such file$"):
        read_motion(tmp_path / "none.nc")
