"""From image files to a recording, by functions and by commands."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.data.validate import faults_of
from crashkit.errors import CrashkitError
from crashkit_cameras import Camera, Laboratory, make_laboratory
from crashkit_cameras.__main__ import main
from crashkit_cameras.tracking import (
    ImageFiles,
    Imaging,
    Painted,
    Pose,
    camera_group,
    combine_views,
    follow,
    mark,
    render,
    write_images,
    write_overlay,
)

pytest.importorskip("cv2")
CONTROL = {f"c{x}{y}{z}": (1.1 * x - 1.1, 1.1 * y - 1.2, 1.7 * z - 0.9) for x in range(3) for y in range(3) for z in range(2)}
POINTS = {"sill": (0.5, 0.4, -0.2), "roof": (-0.3, 0.1, 0.5)}
TIMES = np.arange(4) * 1e-3
CAMERAS = ["left", "right"]


def car(time: float) -> np.ndarray:
    return np.array([-0.4 + 10.0 * time, 0.0, 0.0])


@pytest.fixture(scope="module")
def lab() -> Laboratory:
    return evolve(make_laboratory(2, seed=1), control=np.array(list(CONTROL.values())))


@pytest.fixture(scope="module")
def folder(lab: Laboratory, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The films of two cameras, and an image of the control points by each."""
    folder, imaging = tmp_path_factory.mktemp("films"), Imaging(1024, 1024, noise=2.0, ground=0.4)
    for view, camera in enumerate(CAMERAS):

        def seen(place: np.ndarray, view: int = view) -> Pose:
            return Pose(tuple(lab.images(place)[view]), 9.0, 0.3)

        dots = [Painted(n, "dot", lambda time, p=place, seen=seen: seen(np.array(p))) for n, place in CONTROL.items()]
        targets = [Painted(n, "quadrant", lambda time, p=place, seen=seen: seen(car(time) + p)) for n, place in POINTS.items()]
        write_images(render(dots, imaging, [0.0]), folder / camera / "control")
        write_images(render(targets, imaging, TIMES, view), folder / camera / "film")
    return folder


def shown(lab: Laboratory, places: dict[str, np.ndarray], view: int) -> dict[str, tuple[float, float]]:
    """Where a user clicks."""
    return {name: (float(u), float(v)) for name, (u, v) in ((n, np.rint(lab.images(p)[view])) for n, p in places.items())}


@pytest.fixture(scope="module")
def tracks(lab: Laboratory, folder: Path) -> dict[str, xr.Dataset]:
    places = {name: car(0.0) + point for name, point in POINTS.items()}
    films = [ImageFiles(sorted((folder / camera / "film").glob("*.png")), rate=1000.0) for camera in CAMERAS]
    return {
        c: follow(film, mark(shown(lab, places, v), radius=9.0))
        for v, (c, film) in enumerate(zip(CAMERAS, films, strict=True))
    }


def test_a_folder_of_images_becomes_a_camera_group_that_gives_the_motion(
    lab: Laboratory, folder: Path, tracks: dict[str, xr.Dataset]
) -> None:
    control = {}
    for view, camera in enumerate(CAMERAS):
        still = ImageFiles((folder / camera / "control").glob("*.png"), rate=1.0)[0]
        places = {name: np.array(place) for name, place in CONTROL.items()}
        control[camera] = follow([still], mark(shown(lab, places, view), "dot", 9.0)).isel(time=0).drop_sel(marker="c000")
    markers = {name: ("car", point) for name, point in POINTS.items()}
    group = camera_group(tracks, markers, CONTROL, control, (1024, 1024))
    assert faults_of(group, Camera.schema) == []
    assert np.isnan(group["control_image"].sel(control_point="c000")).all()
    found = Camera().reconstruct(group)
    truth = np.array([car(time) for time in TIMES])
    assert abs(found["position"].values[:, 0] - truth).max() < 1e-3
    with pytest.raises(CrashkitError, match="markers: expected sill, roof, found none of roof"):
        camera_group(tracks, {"sill": markers["sill"]}, CONTROL, control)
    with pytest.raises(CrashkitError, match="control_images: expected left, right, found none of right"):
        camera_group(tracks, markers, CONTROL, {"left": control["left"]})


def test_frames_that_a_camera_does_not_have_are_missing(tracks: dict[str, xr.Dataset]) -> None:
    joined = combine_views({"left": tracks["left"], "right": tracks["right"].isel(time=[1, 3])})
    assert np.isnan(joined["image_position"].sel(view="right").values[[0, 2]]).all()
    assert np.isfinite(joined["image_position"].sel(view="left")).all()
    assert joined["image_position"].attrs["units"] == "pixel"


def test_commands_propose_and_follow(
    lab: Laboratory, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    images = [str(path) for path in sorted((folder / "left" / "film").glob("*.png"))]
    u, v = shown(lab, {"sill": car(0.0) + POINTS["sill"]}, 0)["sill"]
    arguments = [
        "--rate",
        "1000",
        "--radius",
        "9",
        "--output",
        str(tmp_path / "left.nc"),
        "--overlay",
        str(tmp_path / "last.png"),
    ]
    assert main(["follow", *images, "--target", f"sill={u},{v}", *arguments]) == 0
    assert "sill: seen on 4 of 4 images, to 0.00" in capsys.readouterr().out
    track = xr.load_dataset(tmp_path / "left.nc")
    truth = np.array([lab.images(car(time) + POINTS["sill"])[0] for time in TIMES])
    assert abs(track["image_position"].values[:, 0] - truth).max() < 0.03
    assert (tmp_path / "last.png").stat().st_size > 0
    assert main(["detect", str(folder / "missing.png")]) == 1
    assert "expected an image that OpenCV can read, found none" in capsys.readouterr().err


def test_detection_from_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = Painted("target", "quadrant", lambda time: Pose((40.3, 35.7), 9.0))
    (path,) = write_images(render([target], Imaging(80, 80), [0.0]), tmp_path)
    assert main(["detect", str(path), "--overlay", str(tmp_path / "found.png")]) == 0
    assert capsys.readouterr().out.splitlines()[1].startswith("target_1=40.30,35.70")
    assert (tmp_path / "found.png").stat().st_size > 0


def test_images_keep_their_depth(tmp_path: Path) -> None:
    deep = render([], Imaging(20, 20, levels=4095, noise=10.0), [0.0])
    (path,) = write_images(deep, tmp_path)
    again = ImageFiles([path], rate=500.0, first=-0.01)[0]
    assert again.time == -0.01
    np.testing.assert_array_equal(again.image, deep[0].image)
    with pytest.raises(CrashkitError, match="rate of a film: expected frames per second above 0, found 0"):
        ImageFiles([path], rate=0.0)
    with pytest.raises(CrashkitError, match="expected a format and a folder that OpenCV can write to, found none"):
        write_overlay(deep[0].image, mark({"a": (3.0, 4.0)}), tmp_path / "missing" / "a.png")
