"""Images of targets as a camera would take them: for tests, to try settings on, to see what a film can give."""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.signal import fftconvolve

from crashkit_cameras.tracking.frame import Frame

CARD = 1.4
"""Half the width of the card on which a target is printed, in radii."""
INSTANTS_PER_PIXEL = 3
MOST_INSTANTS = 32
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@frozen
class Pose:
    """How a target of a given size looks into the camera: turned in its plane, then tilted about an axis in the image.

    Arguments:
        centre: u, v of its middle, pixel.
        radius: of its disc where it is not tilted, pixel.
        angle: by which it is turned from u towards v, rad.
        tilt: by which its plane is tilted away from the image, rad.
        tilt_axis: angle of the axis about which it is tilted, rad.
        distance: of the camera, in radii of the disc: perspective shows where it is small.
    """

    centre: tuple[float, float]
    radius: float
    angle: float = 0.0
    tilt: float = 0.0
    tilt_axis: float = 0.0
    distance: float = np.inf

    @property
    def homography(self) -> np.ndarray:
        """The matrix that takes points of the target's plane (radius 1, homogeneous) to the image."""
        axis, across = _rotation(self.tilt_axis), np.diag([1.0, np.cos(self.tilt)])
        plane = self.radius * axis @ across @ axis.T @ _rotation(self.angle)
        depth = np.sin(self.tilt) * (axis.T @ _rotation(self.angle))[1] / self.distance
        centre = np.array(self.centre)
        return np.vstack([np.column_stack([plane + np.outer(centre, depth), centre]), [*depth, 1.0]])


@frozen
class Painted:
    """A target on its way through the image.

    Arguments:
        name: of the marker.
        kind: "quadrant", "dot", or "card" (a plain square: something that passes in front).
        pose: where it is at a time, s.
        dark, bright: brightness of its sectors, or of dot and card, 0 to 1.
    """

    name: str
    kind: str
    pose: Callable[[float], Pose]
    dark: float = 0.1
    bright: float = 0.9


@frozen
class Imaging:
    """What a camera makes of a scene.

    Arguments:
        width, height: of the image, pixel.
        exposure: s, symmetrical about the frame's time: what moves is blurred along its way.
        defocus: radius of the disc that a point becomes, pixel.
        noise: standard deviation of a pixel, grey levels.
        light: change of the light for each pixel along u and v, relative to the middle of the image.
        gamma: grey = brightness^(1 / gamma).
        ground: brightness behind the targets, one number or an image.
        levels: the grey of brightness 1; grey is rounded and clipped, as cameras do.
        samples: points in which each side of a pixel is divided.
    """

    width: int
    height: int
    exposure: float = 0.0
    defocus: float = 0.7
    noise: float = 0.0
    light: tuple[float, float] = (0.0, 0.0)
    gamma: float = 1.0
    ground: float | np.ndarray = 0.5
    levels: int = 255
    samples: int = 8


def render(targets: Sequence[Painted], imaging: Imaging, times: Sequence[float] | np.ndarray, seed: int = 0) -> list[Frame]:
    """A film of targets; later ones are in front of earlier ones.

    Every pixel is the mean over many points of its square and over instants of the exposure: no model of a blurred edge.
    """
    random = np.random.default_rng(seed)
    return [Frame(float(time), _exposed(targets, imaging, float(time), random)) for time in times]


def true_position(targets: Sequence[Painted], times: Sequence[float] | np.ndarray) -> xr.DataArray:
    """Where the targets' middles are in the image, pixel, (time, marker, image_axis)."""
    places = [[target.pose(float(time)).centre for target in targets] for time in times]
    coords = {"time": np.asarray(times), "marker": [target.name for target in targets], "image_axis": ["u", "v"]}
    return xr.DataArray(places, coords, ("time", "marker", "image_axis"), attrs={"units": "pixel"})


def _exposed(targets: Sequence[Painted], imaging: Imaging, time: float, random: np.random.Generator) -> np.ndarray:
    image = np.broadcast_to(np.asarray(imaging.ground, dtype=float), (imaging.height, imaging.width)).copy()
    for target in targets:
        _paint(image, target, imaging, time)
    v, u = np.indices(image.shape)
    light = 1.0 + imaging.light[0] * (u - imaging.width / 2) + imaging.light[1] * (v - imaging.height / 2)
    grey = imaging.levels * np.maximum(image * light, 0.0) ** (1.0 / imaging.gamma)
    grey += imaging.noise * random.standard_normal(image.shape)
    return np.rint(grey).clip(0, imaging.levels).astype(np.uint8 if imaging.levels < 256 else np.uint16)


def _paint(image: np.ndarray, target: Painted, imaging: Imaging, time: float) -> None:
    """Put a target over the image, through its coverage of each pixel."""
    poses = [target.pose(instant).homography for instant in _instants(target, imaging.exposure, time)]
    margin = int(np.ceil(imaging.defocus)) + 1
    corners = np.concatenate([_corners(pose) for pose in poses])
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0) - margin
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int), np.array(image.shape[::-1]) - 1) + margin
    if np.any(high - low < 2 * margin):
        return
    n = imaging.samples
    u, v = np.meshgrid(*(low[axis] - 0.5 + (np.arange((high - low + 1)[axis] * n) + 0.5) / n for axis in (0, 1)))
    u += ((GOLDEN * np.arange(len(u))) % 1.0 - 0.5)[:, None] / n  # no edge runs along a line of points
    sharp = np.mean([_seen(target, pose, u, v, n) for pose in poses], axis=0)
    kernel = _disc(imaging.defocus * n)
    covered, painted = (_pixels(fftconvolve(layer, kernel, mode="same"), n)[margin:-margin, margin:-margin] for layer in sharp)
    part = image[low[1] + margin : high[1] - margin + 1, low[0] + margin : high[0] - margin + 1]
    part += painted - covered * part


def _instants(target: Painted, exposure: float, time: float) -> np.ndarray:
    """Instants of the exposure, enough for the way that the target goes in it."""
    ends = [_corners(target.pose(time + part * exposure).homography) for part in (-0.5, 0.5)]
    way = np.max(np.hypot(*(ends[1] - ends[0]).T))
    count = int(np.clip(np.ceil(INSTANTS_PER_PIXEL * way), 1, MOST_INSTANTS))
    return time + exposure * ((np.arange(count) + 0.5) / count - 0.5)


def _corners(homography: np.ndarray) -> np.ndarray:
    """The corners of the card in the image, (corner, u and v)."""
    corners = homography @ np.array([[-CARD, -CARD, CARD, CARD], [-CARD, CARD, -CARD, CARD], [1.0, 1.0, 1.0, 1.0]])
    return (corners[:2] / corners[2]).T


def _seen(target: Painted, homography: np.ndarray, u: np.ndarray, v: np.ndarray, n: int) -> np.ndarray:
    """Coverage, and coverage times brightness, at points of the image, n for each pixel along and across."""
    plane = np.linalg.inv(homography)
    s, t, depth = np.tensordot(plane, np.stack([u, v, np.ones_like(u)]), 1)
    s, t = s / depth, t / depth
    slope_s, slope_t = (
        (plane[i, 0] + 1j * plane[i, 1] - x * (plane[2, 0] + 1j * plane[2, 1])) / depth for i, x in ((0, s), (1, t))
    )
    covered = 0.5 * (1.0 + _step(CARD - np.abs(s), slope_s, n)) * 0.5 * (1.0 + _step(CARD - np.abs(t), slope_t, n))
    if target.kind == "card":
        return np.stack([covered, covered * target.dark])
    distance = np.hypot(s, t)
    printed = 0.5 * (1.0 + _step(1.0 - distance, (s * slope_s + t * slope_t) / np.maximum(distance, 1e-9), n))
    if target.kind == "quadrant":
        printed = printed * 0.5 * (1.0 + _step(s, slope_s, n) * _step(t, slope_t, n))
    return np.stack([covered, covered * (target.bright + (target.dark - target.bright) * printed)])


def _step(height: np.ndarray, slope: np.ndarray, n: int) -> np.ndarray:
    """-1 where a height is below 0 and 1 where it is above, going over within a point's share of a pixel."""
    return (2.0 * n * height / np.maximum(np.abs(slope), 1e-9)).clip(-1.0, 1.0)


def _disc(radius: float) -> np.ndarray:
    reach = np.arange(-np.floor(radius), np.floor(radius) + 1)
    disc = (reach**2 + reach[:, None] ** 2 <= radius**2).astype(float)
    return disc / disc.sum()


def _pixels(points: np.ndarray, n: int) -> np.ndarray:
    """The mean over the n by n points of each pixel."""
    height, width = points.shape
    return points.reshape(height // n, n, width // n, n).mean(axis=(1, 3))


def _rotation(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
