"""A laboratory made of numbers: cameras about a volume, control points, lenses that bend, readings with noise."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit_cameras.camera import Camera
from crashkit_cameras.control import AXES
from crashkit_cameras.marker_motion import marker_motion
from crashkit_cameras.projection import Cameras, depths, project
from crashkit_cameras.result import IMAGE_AXES

HALF_VOLUME = (1.55, 1.55, 1.05)
"""m; the control points lie in a box of twice this size about the origin."""
DISTANCE = 7.0
FOCAL = 1300.0
DISTORTION = (-0.14, 0.04, 0.0, 8e-4, 6e-4)
"""k1, k2, k3, p1, p2 of the cameras on average; the signs of p1 and p2 are drawn."""

Markers = Mapping[str, tuple[str, Sequence[float]]]
"""The body that carries each marker, and the marker's place in the body's frame (3,), m, by the marker's name."""


@frozen(eq=False)
class Laboratory:
    """True cameras, and control points of known place.

    Attributes:
        cameras: of V views, as they really are.
        control: (control_point, 3), m.
        image_size: (width, height), pixel.
        noise: standard deviation of a reading in the image, pixel.
    """

    cameras: Cameras
    control: np.ndarray
    image_size: tuple[float, float] = (1024.0, 1024.0)
    noise: float = 0.3

    def images(self, points: np.ndarray, random: np.random.Generator | None = None) -> np.ndarray:
        """The readings of points (..., 3) m in all views, (view, ..., 2) pixel; NaN outside the image or behind the camera.

        Arguments:
            points: in the laboratory frame.
            random: draws the noise; None: the readings are perfect.
        """
        flat = np.reshape(points, (-1, 3))
        image = project(self.cameras, flat)
        inside = (depths(self.cameras, flat) > 0.0) & ((image > 0.0) & (image < self.image_size)).all(axis=2)
        image = np.where(inside[..., None], image, np.nan)
        if random is not None:
            image += self.noise * random.standard_normal(image.shape)
        return image.reshape(-1, *np.shape(points)[:-1], 2)

    def record(
        self, motion: xr.Dataset, markers: Markers, times: np.ndarray, random: np.random.Generator | None = None
    ) -> xr.Dataset:
        """A camera group: what an analyst reads from the films of a motion.

        Arguments:
            motion: of the bodies that carry the markers.
            markers: where they are fixed.
            times: of the frames, (time,), s.
            random: draws the noise; None: the readings are perfect.
        """
        bodies = [body for body, _ in markers.values()]
        points = np.array([point for _, point in markers.values()], dtype=float)
        positions = marker_motion(Camera(), motion, bodies, points, AXES, times, in_space=True).position
        return self.record_points(positions, times, random).assign(
            marker=list(markers), marker_body=("marker", bodies), marker_point=(("marker", "axis"), points, {"units": "m"})
        )

    def record_points(self, positions: np.ndarray, times: np.ndarray, random: np.random.Generator | None = None) -> xr.Dataset:
        """A camera group of markers anywhere, each the only one of a body of the same name.

        Arguments:
            positions: (time, marker, 3), m.
            times: (time,), s.
            random: draws the noise; None: the readings are perfect.
        """
        names = [f"marker_{number + 1}" for number in range(positions.shape[1])]
        views = [f"camera_{number + 1}" for number in range(len(self.cameras))]
        control = self.images(self.control, random).transpose(1, 0, 2)
        image = self.images(positions, random).transpose(1, 0, 2, 3)
        pixel, metre = {"units": "pixel"}, {"units": "m"}
        return xr.Dataset(
            {
                "image_position": (("time", "view", "marker", "image_axis"), image, pixel),
                "control_position": (("control_point", "axis"), self.control, metre),
                "control_image": (("control_point", "view", "image_axis"), control, pixel),
                "image_size": (("view", "image_axis"), np.tile(self.image_size, (len(views), 1)), pixel),
                "marker_body": ("marker", names),
                "marker_point": (("marker", "axis"), np.zeros((len(names), 3)), metre),
            },
            {
                "time": ("time", times, {"units": "s"}),
                "view": views,
                "marker": names,
                "control_point": [f"control_{number + 1}" for number in range(len(self.control))],
                "axis": AXES,
                "image_axis": IMAGE_AXES,
            },
            {"observer": "camera"},
        )


def make_laboratory(views: int = 2, control_points: int = 20, seed: int = 0, noise: float = 0.3) -> Laboratory:
    """Cameras of 1024 x 1024 pixels and focal length 1300 pixels, on an arc seven metres from a volume of 3.1 x 3.1 x 2.1 m.

    Each lens has radial and decentring distortion of its own, which shifts the corners of the image by some twenty pixels
    and the principal point from its middle by ten.

    Arguments:
        views: number of cameras.
        control_points: scattered over the volume.
        seed: of everything that is drawn.
        noise: standard deviation of a reading in the image, pixel.
    """
    random = np.random.default_rng(seed)
    control = random.uniform(-1.0, 1.0, (control_points, 3)) * HALF_VOLUME
    return Laboratory(_cameras(views, random), control, noise=noise)


def _cameras(views: int, random: np.random.Generator) -> Cameras:
    spread = 0.5 * min(50.0 * (views - 1), 120.0)
    azimuth = np.radians(np.linspace(-spread, spread, views))
    elevation = np.radians(np.resize([10.0, 25.0, 5.0], views))
    position = DISTANCE * np.stack(
        [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)], axis=1
    )
    signs = np.column_stack([np.ones((views, 3)), random.choice([-1.0, 1.0], (views, 2))])
    return Cameras(
        rotation=np.stack([_looking(place) for place in position]),
        position=position,
        focal=FOCAL * (1.0 + 0.01 * random.standard_normal(views)),
        aspect=np.ones(views),
        skew=np.zeros(views),
        centre=512.0 + 10.0 * random.standard_normal((views, 2)),
        distortion=np.array(DISTORTION) * signs * (1.0 + 0.1 * random.standard_normal((views, 1))),
    )


def _looking(position: np.ndarray) -> np.ndarray:
    """Laboratory axes to those of a camera there that looks at the origin, the z axis up in its image."""
    forward = -position / np.linalg.norm(position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])
