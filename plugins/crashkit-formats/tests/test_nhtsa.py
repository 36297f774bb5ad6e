"""The NHTSA reader on a folder of four curves, and on a real test."""

import os
import tarfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crashkit.data import read_recording, write_recording
from crashkit.errors import CrashkitError
from crashkit_formats.nhtsa import NhtsaImporter

TIME = np.arange(-500, 1500) * 1e-4
EV5 = """# Source: NHTSA Vehicle Database - Test Number: 1
----- EV5 -----
----- TEST -----
V5|A TEST \xe9|OBJ|03/OCT/2017|LAB|C|R|NCA|VTB|CON|DRY|22|OTH|OTH|36.0|0|0|0|9|NONE
----- INSTRUMENTATION -----
1|93|AC|NA|FLLR|XG|SEC|G'S|2800|MFG|D|800|2|36.0|-500|1499|100|AM|P|LEFT X
1|94|AC|NA|FLRR|XG|SEC|G'S|2800|MFG|D|800|2|36.0|-500|1499|100|AM|P|RIGHT X
1|96|AC|NA|ENGN|XG|SEC|G'S|2800|MFG|D|800|2|36.0|-500|699|100|CF|P|ENGINE X: No valid data after 70ms
1|97|AC|NA|FLLR|ZG|SEC|G'S|2800|MFG|D|800|2|0.0|-500|1499|100|AM|P|LEFT Z
1|98|DS|01|CHST|XG|SEC|MM|2800|MFG|D|800|2|0.0|-500|1499|100|AM|P|CHEST
0|107|LC|NA|LC01|XG|SEC|NWT|2800|MFG|D|300000|1|0.0|-500|1499|100|AM|P|BARRIER 1 Fx
0|108|LC|NA|LC01|YG|SEC|NWM|2800|MFG|D|14025|1|0.0|-500|1499|100|AM|P|BARRIER 1 My
0|109|LC|NA|LC02|XG|SEC|NWT|2800|MFG|D|300000|1|0.0|-500|1499|100|CF|P|BARRIER 2 Fx: No valid data
0|110|LC|NA|LC03|XG|SEC|NWT|2800|MFG|D|300000|1|0.0|-500|1499|100|AM|P|BARRIER 3 Fx
0|111|LC|NA|LC04|XG|SEC|NWT|2800|MFG|D|300000|1|0.0|-500|1499|100|AM|P|BARRIER 4 Fx
"""
CURVES = {
    93: np.where(TIME < 0, 0.5, 0.5 - 10.0),
    94: np.where(TIME < 0, 0.0, -20.0),
    96: np.where(TIME < 0, 0.0, -30.0)[:1200],
    97: np.zeros(2000),
    98: np.zeros(2000),
    107: np.where(TIME < 0, 0.0, -1000.0),
    109: np.zeros(2000),
    110: np.where(TIME < 0, 0.0, -500.0),
}


def write_curve(path: Path, values: np.ndarray) -> Path:
    path.write_text("".join(f"{time:.6f}\t{value:.6f}\n" for time, value in zip(TIME, values, strict=False)))
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "v00001.EV5").write_text(EV5, encoding="latin-1")
    for number in (93, 94, 96, 97, 98):
        write_curve(tmp_path / f"v00001.{number:03d}", CURVES[number])
    with tarfile.open(tmp_path / "barrier.tar.xz", "w:xz") as archive:
        for number in (107, 109, 110):
            path = write_curve(tmp_path / f"v00001.{number:03d}", CURVES[number])
            archive.add(path, arcname=f"./{path.name}")
            path.unlink()
    return tmp_path


Read = Callable[..., xr.DataTree]


@pytest.fixture
def read(folder: Path) -> Read:
    return lambda *channels, **options: NhtsaImporter().read(folder, channels, options)


def test_channels_tell_what_is_there(folder: Path) -> None:
    found = NhtsaImporter().channels(folder)
    assert found.attrs["title"] == "A TEST \xe9"
    assert found.sizes["channel"] == 10
    top = found.sel(channel=93)
    assert [top[name].item() for name in ("sensor_type", "location", "axis", "unit", "comment")] == [
        *("AC", "FLLR", "XG", "G'S", "LEFT X")
    ]
    assert found.samples.sel(channel=[94, 96, 107, 111]).values.tolist() == [2000, 1200, 2000, 0]
    assert found.present.sel(channel=[107, 111]).values.tolist() == [True, False]


def test_a_recording_of_two_instruments(read: Read) -> None:
    with pytest.warns(UserWarning, match=r"left out curves without valid data: 109 \(BARRIER 2 Fx: No valid data\), 111"):
        run = read("93+94=vehicle:compartment", "-107..111=barrier:wall", window="0:0.12")
    assert run.attrs == {"crashkit_schema": "recording/1", "title": "A TEST \xe9"}
    assert run["initial"].ds.velocity.sel(axis="x").to_series().to_dict() == {"vehicle": 10.0, "barrier": 0.0}
    assert run["initial"].ds.position.values.tolist() == [[0.0], [0.0]]

    acceleration = run["accelerometer"].ds.acceleration.sel(sensor="compartment", axis="x")
    assert acceleration.dims == ("time",)
    assert acceleration.units == "m s-2"
    np.testing.assert_allclose(acceleration, -15.0 * 9.80665)  # the mean of both, the offset of 93 taken off
    assert run["accelerometer"].attrs == {"observer": "accelerometer", "channel_frequency_class": 0, "frame": "laboratory"}

    wall = run["load_cell"].ds
    np.testing.assert_allclose(wall.force.sel(sensor="wall", axis="x"), 1500.0)  # the sum, pushed towards +x
    assert wall.sensor_body.item() == "barrier"
    assert wall.sensor_curves.item() == "107+110"
    np.testing.assert_allclose(wall.time.values[[0, -1]], [0.0, 0.12], atol=1e-12)


def test_a_recording_keeps_the_contract_on_disk(read: Read, tmp_path: Path) -> None:
    run = read("93+94=vehicle:compartment", "96=engine", "-107+110=barrier:wall", channel_frequency_class="180")
    write_recording(run, tmp_path / "run.nc")
    found = read_recording(tmp_path / "run.nc", {})
    assert found["accelerometer"].sensor_body.values.tolist() == ["vehicle", "engine"]
    np.testing.assert_array_equal(found["load_cell"].ds.force, run["load_cell"].ds.force)


def test_sensors_are_named_after_place_axis_and_curves(read: Read) -> None:
    assert read("93=vehicle", "93+94=vehicle", "-94=vehicle")["accelerometer"].sensor.values.tolist() == [
        *("FLLR_XG_93", "FLLR_XG_93_94", "FLRR_XG_94")
    ]


def test_a_curve_that_stops_early_ends_in_nan(read: Read) -> None:
    acceleration = read("96=engine", "93=vehicle")["accelerometer"].ds.acceleration.isel(axis=0)
    assert acceleration.sizes == {"time": 1500, "sensor": 2}
    assert np.isfinite(acceleration.sel(sensor="ENGN_XG_96")).sum() == 700
    assert np.isfinite(acceleration.sel(sensor="FLLR_XG_93")).all()


def test_joined_curves_end_with_the_shortest(read: Read) -> None:
    assert read("96+93=vehicle")["accelerometer"].sizes["time"] == 700


def test_the_filter_sees_what_lies_before_the_window(read: Read) -> None:
    filtered = read("94=vehicle", window="0:0.12", channel_frequency_class="60")["accelerometer"]
    assert filtered.attrs["channel_frequency_class"] == 60
    values = filtered.ds.acceleration.values[:, 0, 0]
    assert -0.7 * 20 * 9.80665 < values[0] < -0.3 * 20 * 9.80665  # half way up the step, which a cut record would not show
    np.testing.assert_allclose(values[400:800], -20 * 9.80665, rtol=1e-3)


def test_offset_speed_and_position_are_the_users_to_choose(read: Read) -> None:
    run = read("93=vehicle", "107=barrier", zero="off", speed="vehicle:12.5", position="vehicle:-0.5")
    assert run["accelerometer"].ds.acceleration.values[0, 0, 0] == pytest.approx(-9.5 * 9.80665)
    assert run["initial"].ds.velocity.values.tolist() == [[12.5], [0.0]]
    assert run["initial"].ds.position.values.tolist() == [[-0.5], [0.0]]


def test_a_loose_file_wins_over_the_archive(folder: Path, read: Read) -> None:
    write_curve(folder / "v00001.107", 2 * CURVES[107])
    assert read("107=barrier")["load_cell"].ds.force.values[0, 0, 0] == -2000.0


@pytest.mark.parametrize(
    ("channels", "options", "message"),
    [
        ([], {}, "expected at least one channel like .*, found none"),
        (["93"], {}, "expected a channel like 93.94=vehicle:compartment .*, found '93'"),
        (["9x=vehicle"], {}, "expected a curve number or a range like 107..632, found '9x'"),
        (["12=vehicle"], {}, "curve 12: expected one of the curves of the EV5 file, found none of that number"),
        (["109=barrier"], {}, "curve 109: expected valid data, found the comment 'BARRIER 2 Fx: No valid data'"),
        (["111=barrier"], {}, r"curve 111: expected a data file, found none \(BARRIER 4 Fx\)"),
        (["111..111=barrier"], {}, "channel 111..111=barrier: expected at least one curve with data, found none"),
        (["93+97=vehicle"], {}, "expected curves of one sensor type, axis and unit, found AC XG G'S, AC ZG G'S"),
        (["93+93=vehicle"], {}, "expected each curve once, found curve 93 twice"),
        (["93=vehicle", "97=vehicle"], {}, "expected channels of one axis x, y or z, found x, z"),
        (["98=driver"], {}, "curve 98: expected AC in G'S or LC in NWT, found DS in MM"),
        (["93=a:s", "94=b:s"], {}, "expected a name of its own for each accelerometer, found s, s"),
        (["93=vehicle"], {"windw": "0:1"}, "expected the options window, .*, found windw"),
        (["93=vehicle"], {"window": "0.1"}, "option window: expected START:END in seconds, found '0.1'"),
        (["93=vehicle"], {"window": "1:2"}, "expected samples within the window, found 0"),
        (["93=vehicle"], {"window": "a:b"}, "option window: expected a number, found 'a'"),
        (["93=vehicle"], {"channel_frequency_class": "61"}, "expected one of 0, 60, 180, 600, 1000, found '61'"),
        (["93=vehicle"], {"zero": "-1:-0.5"}, "expected samples between -1 and -0.5 s to take the offset from"),
        (["93=vehicle"], {"speed": "car:3"}, "option speed: expected one of the bodies vehicle, found car"),
        (["93=vehicle"], {"speed": "fast"}, "option speed: expected a number, found 'fast'"),
    ],
)
def test_a_wrong_choice_is_one_line(read: Read, channels: list[str], options: dict[str, str], message: str) -> None:
    with pytest.raises(CrashkitError, match=message) as caught:
        read(*channels, **options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0.0\t1.0\n0.1\tnan\n", "v00001.093, line 2: expected finite numbers, found 0.1 nan"),
        ("0.0\t1.0\n\n0.1\tx\n", r"v00001.093, line 3: expected time and value, found '0.1\\tx'"),
        ("0.0\t1.0\n0.1\t1.0\n0.1\t1.0\n", "v00001.093, line 3: expected increasing time, found 0.1 s"),
        ("0.0\t1.0\n", "v00001.093: expected at least two samples, found 1"),
    ],
)
def test_a_damaged_curve_names_file_and_line(folder: Path, read: Read, text: str, message: str) -> None:
    (folder / "v00001.093").write_text(text)
    with pytest.raises(CrashkitError, match=message):
        read("93=vehicle")


def test_other_time_stamps_are_refused(folder: Path, read: Read) -> None:
    write_curve(folder / "v00001.094", CURVES[94])
    text = (folder / "v00001.094").read_text().replace("-0.049900", "-0.049950")
    (folder / "v00001.094").write_text(text)
    with pytest.raises(CrashkitError, match="v00001.094: expected the time stamps of v00001.093, found others"):
        read("93+94=vehicle")
    with pytest.raises(CrashkitError, match="expected the time stamps of the other sensors, found others"):
        read("93=vehicle", "94=vehicle", window=":0.1")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("|36.0|0|0|0|9|", "|fast|0|0|0|9|", "v00001.EV5: line 4: expected the closing speed in km/h, found 'fast'"),
        ("1|93|AC|NA|", "1|93|", "v00001.EV5: line 6: expected 20 fields of a curve, found 18"),
        ("1|93|AC|NA|", "1|x|AC|NA|", "v00001.EV5: line 6: expected a whole number, found 'x'"),
        ("----- INSTR", "----- OTHER", "v00001.EV5: section INSTRUMENTATION: expected a line for each curve, found none"),
        ("----- TEST", "----- TASTE", "v00001.EV5: section TEST: expected a line of more than 14 fields, found none"),
    ],
)
def test_a_damaged_ev5_names_the_line(folder: Path, read: Read, old: str, new: str, message: str) -> None:
    (folder / "v00001.EV5").write_text(EV5.replace(old, new), encoding="latin-1")
    with pytest.raises(CrashkitError, match=message):
        read("93=vehicle")


def test_two_vehicles_need_their_speeds(folder: Path, read: Read) -> None:
    (folder / "v00001.EV5").write_text(EV5.replace("1|94|", "2|94|"), encoding="latin-1")
    with pytest.raises(CrashkitError, match="two vehicles: expected the option speed for every body"):
        read("93=first", "94=second")
    run = read("93=first", "94=second", speed="first:10,second:-10")
    assert run["initial"].ds.velocity.values.tolist() == [[10.0], [-10.0]]


def test_a_folder_that_is_not_there_or_has_no_ev5(tmp_path: Path) -> None:
    with pytest.raises(CrashkitError, match="none: expected a folder of NHTSA text files, found nothing"):
        NhtsaImporter().channels(tmp_path / "none")
    with pytest.raises(CrashkitError, match="expected one EV5 file, found none"):
        NhtsaImporter().channels(tmp_path)


def test_a_truncated_archive_is_named(folder: Path, read: Read) -> None:
    archive = folder / "barrier.tar.xz"
    archive.write_bytes(archive.read_bytes()[:200])
    with pytest.raises(CrashkitError, match="barrier.tar.xz: expected a readable tar archive, found"):
        read("93=vehicle")


RECORDINGS = Path(os.environ.get("CRASHKIT_RECORDINGS", Path(__file__).parents[4] / "shared" / "recordings"))
CAMRY = RECORDINGS / "nhtsa_v10146_camry_ncap_frontal"


needs_camry = pytest.mark.skipif(not CAMRY.is_dir() and not os.environ.get("CI"), reason=f"no recordings in {RECORDINGS}")


@pytest.fixture(scope="module")
def camry() -> xr.DataTree:
    """Test 10146: a 1719 kg car at 57.09 km/h against a wall of 176 load cells, two of them dead."""
    channels = ["93+94+99+100=vehicle:compartment", "95=engine:top", "96=engine:bottom", "-107..632=barrier:wall"]
    with pytest.warns(UserWarning, match=r"347 \(BARRIER F-01 Fx: No valid data\), 500 \(BARRIER C-04 Fx: No valid data\)"):
        return NhtsaImporter().read(CAMRY, channels, {"channel_frequency_class": "60", "window": "0:0.15"})


@needs_camry
def test_camry_channels() -> None:
    found = NhtsaImporter().channels(CAMRY)
    assert found.sizes["channel"] == 634
    assert found.samples.sel(channel=[95, 96, 107]).values.tolist() == [3500, 1170, 3500]


@needs_camry
def test_camry_impulse_of_the_wall(camry: xr.DataTree) -> None:
    wall = camry["load_cell"].ds.force.isel(sensor=0, axis=0)
    assert len(camry["load_cell"].ds.sensor_curves.item().split("+")) == 174
    assert np.trapezoid(wall, wall.time) == pytest.approx(32.84e3, rel=0.01)


@needs_camry
def test_camry_velocity_change_of_the_compartment(camry: xr.DataTree) -> None:
    acceleration = camry["accelerometer"].ds.acceleration.sel(sensor="compartment", axis="x")
    assert -np.trapezoid(acceleration, acceleration.time) == pytest.approx(18.08, rel=0.01)


@needs_camry
def test_camry_meets_the_wall_at_the_closing_speed(camry: xr.DataTree) -> None:
    velocity = camry["initial"].ds.velocity.isel(axis=0).to_series().to_dict()
    assert velocity == pytest.approx({"vehicle": 57.09 / 3.6, "engine": 57.09 / 3.6, "barrier": 0.0})


@needs_camry
def test_camry_engine_curve_that_stops_ends_in_nan(camry: xr.DataTree) -> None:
    bottom = camry["accelerometer"].ds.acceleration.sel(sensor="bottom", axis="x")
    assert np.isnan(bottom.where(bottom.time > 0.067, drop=True)).all()
    assert np.isfinite(bottom.where(bottom.time < 0.0669, drop=True)).all()
