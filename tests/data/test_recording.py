import shutil
import subprocess

import netCDF4
import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from crashkit.data import check_recording, instruments, read_recording, unknown_observers, write_recording
from crashkit.errors import ContractError, CrashkitError
from crashkit.testing.strategies import recordings

SAMPLES = ["sample_null", "sample_two", "sample_cargo"]


def with_time(dataset: xr.Dataset, stamps: list[float]) -> xr.Dataset:
    return dataset.assign_coords(time=("time", stamps, {"units": "s"}))


class TestRoundTrip:
    def test_written_and_read_is_identical(self, tmp_path, recording, schemas):
        write_recording(recording, tmp_path / "run.nc")
        assert read_recording(tmp_path / "run.nc", schemas).identical(recording)

    @settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
    @given(st.data())
    def test_any_recording_written_and_read_is_identical(self, tmp_path_factory, schemas, data):
        recording = data.draw(recordings(schemas))
        path = tmp_path_factory.mktemp("recording") / "run.nc"
        write_recording(recording, path)
        assert read_recording(path, schemas).identical(recording)

    @pytest.mark.parametrize("case", SAMPLES)
    def test_samples_written_and_read_are_identical(self, tmp_path, cases, schemas, case):
        for path in sorted((cases / case).glob("*.nc")):
            recording = read_recording(path, schemas)
            write_recording(recording, tmp_path / path.name)
            assert read_recording(tmp_path / path.name, schemas).identical(recording)

    def test_extras_are_kept(self, tmp_path, recording, schemas):
        recording["film"] = recording["film"].to_dataset().assign(light=("time", np.arange(4.0))).assign_attrs(lens="50 mm")
        recording["notes"] = xr.Dataset(attrs={"driver": "none"})
        write_recording(recording, tmp_path / "run.nc")
        found = read_recording(tmp_path / "run.nc", schemas)
        assert found["film"]["light"].values.tolist() == [0.0, 1.0, 2.0, 3.0]
        assert found["film"].attrs["lens"] == "50 mm"
        assert found["notes"].attrs == {"driver": "none"}

    def test_text_and_numbers_come_back_plain(self, tmp_path, recording, schemas):
        write_recording(recording, tmp_path / "run.nc")
        group = read_recording(tmp_path / "run.nc", schemas)["accelerometer"]
        assert group["sensor_body"].dtype.kind == group["sensor"].dtype.kind == "U"
        assert [type(value) for value in group.attrs.values()] == [str, int, str]

    def test_the_file_is_closed_and_may_be_replaced(self, tmp_path, recording, schemas):
        write_recording(recording, tmp_path / "run.nc")
        first = read_recording(tmp_path / "run.nc", schemas)
        recording.attrs["title"] = "another"
        write_recording(recording, tmp_path / "run.nc")
        assert read_recording(tmp_path / "run.nc", schemas).attrs["title"] == "another"
        (tmp_path / "run.nc").unlink()
        assert first["film"]["position"].values[3, 1, 0] == 7.0


class TestOtherTools:
    @pytest.mark.skipif(shutil.which("ncdump") is None, reason="ncdump is not installed")
    def test_opens_in_ncdump(self, tmp_path, recording):
        write_recording(recording, tmp_path / "run.nc")
        dump = subprocess.run(["ncdump", tmp_path / "run.nc"], capture_output=True, text=True, check=True).stdout
        assert 'crashkit_schema = "recording/1"' in dump
        assert "double position(time, marker, axis)" in dump
        assert 'marker_body = "engine", "body" ;' in dump

    def test_opens_in_plain_xarray(self, tmp_path, recording):
        write_recording(recording, tmp_path / "run.nc")
        with xr.open_datatree(tmp_path / "run.nc") as tree:
            assert tree["film"]["time"].values.tolist() == [0.0, 0.001, 0.002, 0.004]
            assert tree["film"]["marker"].values.tolist() == ["m1", "m2"]

    def test_a_file_written_by_hand_with_xarray(self, tmp_path, film, accelerometer, initial, schemas):
        root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": "by hand"})
        groups = {"/": root, "initial": initial, "film": film, "accelerometer": accelerometer}
        xr.DataTree.from_dict(groups).to_netcdf(tmp_path / "run.nc")
        found = read_recording(tmp_path / "run.nc", schemas)
        assert found["film"]["marker_body"].values.tolist() == ["engine", "body"]
        assert instruments(found) == {"film": "film", "accelerometer": "accelerometer"}

    def test_a_file_with_text_as_bytes(self, tmp_path, film, schemas):
        film["marker_body"] = film["marker_body"].astype("S")
        film["marker"] = film["marker"].astype("S")
        root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": "by hand"})
        xr.DataTree.from_dict({"/": root, "film": film}).to_netcdf(tmp_path / "run.nc")
        found = read_recording(tmp_path / "run.nc", schemas)
        assert found["film"]["marker_body"].values.tolist() == ["engine", "body"]
        assert found["film"]["marker"].values.tolist() == ["m1", "m2"]

    def test_axes_that_all_groups_share(self, tmp_path, film, schemas):
        root = xr.Dataset(coords={"axis": ["x"]}, attrs={"crashkit_schema": "recording/1", "title": "shared axis"})
        xr.DataTree.from_dict({"/": root, "film": film.drop_vars("axis")}).to_netcdf(tmp_path / "run.nc")
        assert read_recording(tmp_path / "run.nc", schemas)["film"]["axis"].values.tolist() == ["x"]


class TestFaults:
    def test_every_fault_of_every_group(self, tmp_path, recording, schemas):
        recording.attrs = {"crashkit_schema": "recording/2"}
        recording["initial"]["velocity"].attrs["units"] = "km/h"
        recording["film"]["position"].attrs["units"] = "mm"
        recording["accelerometer"].attrs["frame"] = "car"
        write_recording(recording, tmp_path / "run.nc")
        with pytest.raises(ContractError, match="recording") as caught:
            read_recording(tmp_path / "run.nc", schemas)
        assert str(caught.value).replace(str(tmp_path), "folder").splitlines() == [
            'folder/run.nc: recording: expected attribute crashkit_schema one of "recording/1", found "recording/2"',
            "folder/run.nc: recording: expected attribute title, found none",
            'folder/run.nc: initial/velocity: expected units "m s-1", found "km/h"',
            'folder/run.nc: film/position: expected units "m", found "mm"',
            'folder/run.nc: accelerometer: expected attribute frame one of "body", "laboratory", found "car"',
        ]

    def test_groups_are_named_as_the_file_names_them(self, recording, film, schemas):
        film["position"].attrs["units"] = "mm"
        recording["left"] = film
        with pytest.raises(ContractError, match='^run: left/position: expected units "m", found "mm"$'):
            check_recording(recording, schemas, "run")

    def test_an_observer_that_is_not_installed(self, recording, schemas):
        recording["gyro"] = xr.Dataset({"rate": ("time", [1.0])}, attrs={"observer": "gyroscope"})
        check_recording(recording, schemas, "run")
        assert unknown_observers(recording, schemas) == {"gyro": "gyroscope"}
        assert unknown_observers(recording, {}) == {"film": "film", "accelerometer": "accelerometer", "gyro": "gyroscope"}

    def test_an_observer_that_is_no_text(self, recording, schemas):
        recording["film"].attrs["observer"] = 7
        with pytest.raises(ContractError, match="^run: film: expected attribute observer as text, found 7$"):
            check_recording(recording, schemas, "run")

    def test_an_instrument_within_a_group(self, recording, film, schemas):
        recording["cameras/left"] = film
        message = '^run: cameras/left: expected attribute observer on groups of the first level only, found "film"$'
        with pytest.raises(ContractError, match=message):
            check_recording(recording, schemas, "run")

    def test_no_instruments(self, recording, schemas):
        message = "^run: recording: expected an instrument, a group with the attribute observer, found none$"
        with pytest.raises(ContractError, match=message):
            check_recording(recording.drop_nodes(["film", "accelerometer"]), schemas, "run")

    def test_a_motion(self, schemas):
        motion = xr.DataTree(xr.Dataset({"position": ("time", [0.0])}))
        with pytest.raises(ContractError, match="with the attribute observer, found a motion$"):
            check_recording(motion, schemas, "run")

    @pytest.mark.parametrize(
        ("stamps", "found"),
        [
            ([0.0, 40.0, 80.0, 149.0], "0 to 149 s"),
            ([1.7e9, 1.7e9 + 0.1, 1.7e9 + 0.2, 1.7e9 + 0.3], r"1.7e\+09 to 1.7e\+09 s"),
        ],
        ids=["milliseconds", "since 1970"],
    )
    def test_time_that_is_not_in_the_same_seconds(self, recording, schemas, stamps, found):
        recording["film"] = with_time(recording["film"].to_dataset(), stamps)
        message = rf"^run: film/time: expected the seconds of accelerometer \(0 to 0.0002 s\), found {found}$"
        with pytest.raises(ContractError, match=message):
            check_recording(recording, schemas, "run")

    @pytest.mark.parametrize("stamps", [[0.1, 0.11, 0.12, 0.13], [0.0, 3.0, 6.0, 9.0], [-0.1, 0.0, 0.1, 0.15]])
    def test_an_instrument_may_see_another_part_of_the_crash(self, recording, schemas, stamps):
        recording["film"] = with_time(recording["film"].to_dataset(), stamps)
        check_recording(recording, schemas, "run")


class TestUnreadable:
    def test_no_such_file(self, tmp_path, schemas):
        with pytest.raises(CrashkitError, match=r"none.nc: expected a netCDF file, found no such file$"):
            read_recording(tmp_path / "none.nc", schemas)

    def test_a_model(self, tmp_path, schemas):
        with pytest.raises(CrashkitError, match=r"model.toml: expected a netCDF file, found a model \(TOML\)$"):
            read_recording(tmp_path / "model.toml", schemas)

    def test_a_folder(self, tmp_path, schemas):
        with pytest.raises(CrashkitError, match=r": expected a netCDF file, found a folder$"):
            read_recording(tmp_path, schemas)

    @pytest.mark.parametrize("content", [b"", b"time,position\n0,1\n", b"CDF\x01", b"\x89HDF\r\n\x1a\n"])
    def test_no_netcdf(self, tmp_path, schemas, content):
        (tmp_path / "run.nc").write_bytes(content)
        with pytest.raises(CrashkitError, match=r"run.nc: expected a netCDF file, found one that cannot be read \(.+\)$"):
            read_recording(tmp_path / "run.nc", schemas)

    @pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
    def test_truncated(self, tmp_path, recording, schemas, share):
        write_recording(recording, tmp_path / "run.nc")
        content = (tmp_path / "run.nc").read_bytes()
        (tmp_path / "run.nc").write_bytes(content[: int(share * len(content))])
        with pytest.raises(CrashkitError, match=r"run.nc: expected a netCDF file, found one that cannot be read \(.+\)$"):
            read_recording(tmp_path / "run.nc", schemas)

    def test_a_scale_that_is_no_number(self, tmp_path, schemas):
        with netCDF4.Dataset(tmp_path / "run.nc", "w") as file:
            file.createDimension("time", 2)
            file.createVariable("position", "f8", ("time",)).scale_factor = "large"
        with pytest.raises(CrashkitError, match=r"run.nc: expected a netCDF file, found one that cannot be read \(.+\)$"):
            read_recording(tmp_path / "run.nc", schemas)


class TestWriting:
    def test_what_netcdf_cannot_hold_leaves_the_old_file_alone(self, tmp_path, recording):
        (tmp_path / "run.nc").write_text("old")
        recording["film"].attrs["settings"] = {"gain": 2}
        with pytest.raises(CrashkitError, match=r"run.nc: cannot be written as netCDF \(.+\)$"):
            write_recording(recording, tmp_path / "run.nc")
        assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("run.nc", "old")]

    def test_a_folder_that_is_not_there(self, tmp_path, recording):
        with pytest.raises(CrashkitError, match=r"run.nc: cannot be written: no folder .*none$"):
            write_recording(recording, tmp_path / "none" / "run.nc")

    def test_truth_values_become_numbers(self, tmp_path, recording, schemas):
        recording.attrs["calibrated"] = True
        write_recording(recording, tmp_path / "run.nc")
        assert read_recording(tmp_path / "run.nc", schemas).attrs["calibrated"] == 1
