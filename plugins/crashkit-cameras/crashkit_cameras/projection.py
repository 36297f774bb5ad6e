"""From a point of the laboratory to its place in the images, and the derivatives of that."""

from collections.abc import Sequence

import numpy as np
from attrs import astuple, evolve, frozen

PARAMETERS = 16
"""Of one camera: rotation (3), position (3), focal length, aspect, skew, principal point (2), distortion (5)."""


@frozen(eq=False)
class Cameras:
    """One or several cameras: perspectives with a lens.

    q = R (X - C),  a = (q_x, q_y) / q_z,  r² = a_x² + a_y²,
    b = a (1 + k1 r² + k2 r⁴ + k3 r⁶) + (2 p1 a_x a_y + p2 (r² + 2 a_x²), p1 (r² + 2 a_y²) + 2 p2 a_x a_y),
    u = f (b_x + s b_y) + u_0,  v = f c b_y + v_0.

    Without distortion this is equation (12) of Mizzi & Jezequel (1992); its eleven coefficients and the eleven numbers
    R, C, f, c, s, u_0, v_0 determine each other. The distortion is Brown's (Photogrammetric Engineering 37, 1971, 855-866).

    Attributes:
        rotation: R, (view, 3, 3), laboratory axes to the camera's (right, down, forward).
        position: C, (view, 3), m.
        focal: f, (view,), pixel.
        aspect: c, (view,), height of a pixel's image over its width, 1 for square pixels; negative where v points up.
        skew: s, (view,), 0 where the image's axes are at right angles.
        centre: (u_0, v_0), (view, 2), pixel, the principal point.
        distortion: (k1, k2, k3, p1, p2), (view, 5).
    """

    rotation: np.ndarray
    position: np.ndarray
    focal: np.ndarray
    aspect: np.ndarray
    skew: np.ndarray
    centre: np.ndarray
    distortion: np.ndarray

    def __len__(self) -> int:
        return len(self.focal)

    def select(self, views: slice) -> "Cameras":
        """Some of the views."""
        return Cameras(*(array[views] for array in astuple(self, recurse=False)))

    def numbers(self) -> np.ndarray:
        """The numbers that a prior speaks of, (view, 16): those of `moved`, 0 for the rotation."""
        logarithms = np.log(np.abs(np.stack([self.focal, self.aspect], axis=1)))
        still = np.zeros((len(self), 3))
        return np.concatenate([still, self.position, logarithms, self.skew[:, None], self.centre, self.distortion], axis=1)

    def moved(self, step: np.ndarray) -> "Cameras":
        """Cameras with small changes (view, 16): a rotation vector, C, log f, log |c|, s, (u_0, v_0), distortion."""
        return evolve(
            self,
            rotation=rotation_matrix(step[:, :3]) @ self.rotation,
            position=self.position + step[:, 3:6],
            focal=self.focal * np.exp(step[:, 6]),
            aspect=self.aspect * np.exp(step[:, 7]),
            skew=self.skew + step[:, 8],
            centre=self.centre + step[:, 9:11],
            distortion=self.distortion + step[:, 11:],
        )


def join(parts: Sequence[Cameras]) -> Cameras:
    """The views of several, one after the other."""
    arrays = zip(*(astuple(part, recurse=False) for part in parts), strict=True)
    return Cameras(*(np.concatenate(array) for array in arrays))


def project(cameras: Cameras, points: np.ndarray) -> np.ndarray:
    """The points' places in the images.

    Arguments:
        cameras: of V views.
        points: (N, 3), m.

    Returns:
        (V, N, 2), pixel.
    """
    return _on_image(cameras, _bent(cameras, _straight(_local(cameras, points))))


def depths(cameras: Cameras, points: np.ndarray) -> np.ndarray:
    """How far the points are before the cameras along their axes, (V, N), m."""
    return _local(cameras, points)[..., 2]


def project_with_point_derivatives(cameras: Cameras, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The places (V, N, 2) and their derivatives to the points (V, N, 2, 3), pixel/m."""
    local = _local(cameras, points)
    straight = _straight(local)
    to_local = _to_local(cameras, local, straight)
    return _on_image(cameras, _bent(cameras, straight)), _turned(to_local, cameras.rotation)


def project_with_derivatives(cameras: Cameras, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The places (V, N, 2), their derivatives to the points (V, N, 2, 3) and to the steps of `moved` (V, N, 2, 16)."""
    local = _local(cameras, points)
    straight = _straight(local)
    bent = _bent(cameras, straight)
    image = _on_image(cameras, bent)
    to_local = _to_local(cameras, local, straight)
    to_camera = np.zeros((*image.shape, PARAMETERS))
    to_camera[..., :3] = -(to_local @ cross_matrix(local))
    to_camera[..., 3:6] = -_turned(to_local, cameras.rotation)
    to_camera[..., 6] = image - cameras.centre[:, None]
    to_camera[..., 1, 7] = to_camera[..., 1, 6]
    to_camera[..., 0, 8] = cameras.focal[:, None] * bent[..., 1]
    to_camera[..., 9:11] = np.eye(2)
    to_camera[..., 11:] = _scale(cameras)[:, None] @ _distortion_terms(straight)
    return image, -to_camera[..., 3:6], to_camera


def rotation_matrix(vector: np.ndarray) -> np.ndarray:
    """exp([vector]x), the rotation about a vector by its length; (..., 3) to (..., 3, 3). Rodrigues' formula."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    turn = cross_matrix(vector)
    half = np.sinc(angle / (2.0 * np.pi))
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * turn + 0.5 * half**2 * turn @ turn)


def cross_matrix(vector: np.ndarray) -> np.ndarray:
    """[vector]x, with [v]x w = v x w; (..., 3) to (..., 3, 3)."""
    matrix = np.zeros((*vector.shape, 3))
    for row, column, axis, sign in ((0, 1, 2, -1), (0, 2, 1, 1), (1, 0, 2, 1), (1, 2, 0, -1), (2, 0, 1, -1), (2, 1, 0, 1)):
        matrix[..., row, column] = sign * vector[..., axis]
    return matrix


def _local(cameras: Cameras, points: np.ndarray) -> np.ndarray:
    """q, (V, N, 3)."""
    return np.asarray((points - cameras.position[:, None]) @ cameras.rotation.transpose(0, 2, 1))


def _straight(local: np.ndarray) -> np.ndarray:
    """a, (V, N, 2)."""
    return np.asarray(local[..., :2] / local[..., 2:])


def _bent(cameras: Cameras, straight: np.ndarray) -> np.ndarray:
    """b, (V, N, 2)."""
    x, y, square, radial, (p1, p2) = _lens(cameras, straight)
    bent = straight * radial[..., None]
    bent[..., 0] += 2.0 * p1 * x * y + p2 * (square + 2.0 * x**2)
    bent[..., 1] += p1 * (square + 2.0 * y**2) + 2.0 * p2 * x * y
    return bent


def _on_image(cameras: Cameras, bent: np.ndarray) -> np.ndarray:
    return np.asarray(bent @ _scale(cameras).transpose(0, 2, 1) + cameras.centre[:, None])


def _scale(cameras: Cameras) -> np.ndarray:
    """d(u, v) / d b, (V, 2, 2)."""
    scale = np.zeros((len(cameras), 2, 2))
    scale[:, 0, 0] = cameras.focal
    scale[:, 0, 1] = cameras.focal * cameras.skew
    scale[:, 1, 1] = cameras.focal * cameras.aspect
    return scale


def _lens(
    cameras: Cameras, straight: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """a_x, a_y, r² and the radial factor, (V, N), and p1, p2, (V, 1)."""
    x, y = straight[..., 0], straight[..., 1]
    square = x**2 + y**2
    k1, k2, k3, p1, p2 = cameras.distortion.T[:, :, None]
    return x, y, square, 1.0 + square * (k1 + square * (k2 + square * k3)), (p1, p2)


def _distortion_terms(straight: np.ndarray) -> np.ndarray:
    """d b / d(k1, k2, k3, p1, p2), (V, N, 2, 5)."""
    x, y = straight[..., 0], straight[..., 1]
    square = x**2 + y**2
    terms = np.empty((*straight.shape, 5))
    for power in range(3):
        terms[..., power] = straight * (square ** (power + 1))[..., None]
    terms[..., 0, 3] = terms[..., 1, 4] = 2.0 * x * y
    terms[..., 1, 3] = square + 2.0 * y**2
    terms[..., 0, 4] = square + 2.0 * x**2
    return terms


def _to_local(cameras: Cameras, local: np.ndarray, straight: np.ndarray) -> np.ndarray:
    """d(u, v) / d q, (V, N, 2, 3)."""
    x, y, square, radial, (p1, p2) = _lens(cameras, straight)
    k1, k2, k3 = cameras.distortion.T[:3, :, None]
    growth = 2.0 * (k1 + square * (2.0 * k2 + square * 3.0 * k3))
    across = growth * x * y + 2.0 * (p1 * x + p2 * y)
    along_x = radial + growth * x**2 + 2.0 * p1 * y + 6.0 * p2 * x
    along_y = radial + growth * y**2 + 6.0 * p1 * y + 2.0 * p2 * x
    focal, skew, height = cameras.focal[:, None], cameras.skew[:, None], (cameras.focal * cameras.aspect)[:, None]
    near = 1.0 / local[..., 2]
    to_local = np.empty((*straight.shape, 3))
    to_local[..., 0, 0] = focal * near * (along_x + skew * across)
    to_local[..., 0, 1] = focal * near * (across + skew * along_y)
    to_local[..., 1, 0] = height * near * across
    to_local[..., 1, 1] = height * near * along_y
    to_local[..., 2] = -(to_local[..., 0] * x[..., None] + to_local[..., 1] * y[..., None])
    return to_local


def _turned(to_local: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Derivatives to q (V, N, 2, 3) as derivatives to the points; flat, because many small products are slow."""
    views, points = to_local.shape[:2]
    return np.asarray((to_local.reshape(views, 2 * points, 3) @ rotation).reshape(to_local.shape))
