"""The direct linear transformation: a camera's coefficients from control points, and what they say of the camera."""

import numpy as np
from attrs import frozen
from scipy.linalg import rq

from crashkit_cameras.projection import PARAMETERS, Cameras, cross_matrix

COEFFICIENTS = ("L1", "L2", "L3", "L4", "L5", "L6", "L7", "L8", "L9", "L10", "L11", "k1", "k2", "k3", "p1", "p2")
"""Eleven of the perspective, three of radial and two of decentring distortion."""
LINEAR = 11
SUBSET, SUBSETS = 7, 100
"""Least size and number of the random subsets of a robust fit."""


@frozen(eq=False)
class LinearFit:
    """Eleven coefficients by linear least squares, and how well the points determine them.

    Attributes:
        coefficients: (11,).
        condition: ratio of the largest to the smallest singular value of the normalised equations.
    """

    coefficients: np.ndarray
    condition: float


def fit_linear(points: np.ndarray, image: np.ndarray) -> LinearFit:
    """The eleven coefficients of a camera by least squares, orthogonalised by Householder's reflections.

    u = (L1 X + L2 Y + L3 Z + L4) / (L9 X + L10 Y + L11 Z + 1),
    v = (L5 X + L6 Y + L7 Z + L8) / (L9 X + L10 Y + L11 Z + 1),
    multiplied by the denominator: equations (12), (14) and (15) of Mizzi & Jezequel (1992). Both sets of points are first
    shifted to their mean and scaled to the same size, without which the equations lose half the digits
    (Hartley, IEEE Trans. PAMI 19, 1997, 580-593).

    Arguments:
        points: (n, 3), m, n of 6 or more, not in a plane.
        image: (n, 2), pixel.
    """
    to_points, to_image = _normalisation(points), _normalisation(image)
    matrix, right = _equations(_transformed(to_points, points), _transformed(to_image, image))
    orthogonal, triangle = np.linalg.qr(matrix)
    solution = np.linalg.lstsq(triangle, orthogonal.T @ right)[0]
    normalised = np.append(solution, 1.0).reshape(3, 4)
    matrix = np.linalg.solve(to_image, normalised) @ to_points
    return LinearFit(matrix.ravel()[:LINEAR] / matrix[2, 3], float(np.linalg.cond(triangle)))


def fit_linear_robust(points: np.ndarray, image: np.ndarray) -> LinearFit:
    """Eleven coefficients that fit most of the points, whatever the others are.

    Of many fits to random subsets, the one with the least median residual (Rousseeuw, JASA 79, 1984, 871-880). The subsets
    are the same at every call.
    """
    random = np.random.default_rng(0)
    size = max(SUBSET, len(points) // 2)
    subsets = [random.permutation(len(points))[:size] for _ in range(SUBSETS)]
    fits = [fit_linear(points[subset], image[subset]) for subset in subsets]
    return min(fits, key=lambda fit: float(np.median(_residual(fit.coefficients, points, image))))


def solve_points(coefficients: np.ndarray, image: np.ndarray) -> np.ndarray:
    """Points by linear least squares over the views that saw them.

    Arguments:
        coefficients: (view, 11 or more); distortion is left out.
        image: (view, point, 2), pixel, NaN where a point is hidden.

    Returns:
        (point, 3), m; NaN where fewer than two views saw it.
    """
    matrix = _projection_matrices(coefficients)[:, None]
    rows = matrix[:, :, :2] - image[..., None] * matrix[:, :, 2:]
    seen = np.isfinite(rows).all(axis=(2, 3))
    rows = np.where(seen[:, :, None, None], rows, 0.0).transpose(1, 0, 2, 3).reshape(image.shape[1], -1, 4)
    normal = rows[..., :3].transpose(0, 2, 1) @ rows[..., :3]
    right = -(rows[..., :3].transpose(0, 2, 1) @ rows[..., 3:])[..., 0]
    found = np.full((image.shape[1], 3), np.nan)
    enough = seen.sum(axis=0) >= 2
    found[enough] = np.linalg.solve(normal[enough], right[enough, :, None])[..., 0]
    return found


def cameras_of(coefficients: np.ndarray, inside: np.ndarray) -> Cameras:
    """The cameras of 11 or 16 coefficients each.

    Arguments:
        coefficients: (view, 11 or 16).
        inside: (3,), m, a point in front of all cameras, for example the mean of the control points.
    """
    matrices = _projection_matrices(coefficients)
    parts = [_decomposed(matrix, inside) for matrix in matrices]
    inner = np.stack([part[0] for part in parts])
    rotation = np.stack([part[1] for part in parts])
    distortion = np.zeros((len(matrices), PARAMETERS - LINEAR))
    distortion[:, : coefficients.shape[1] - LINEAR] = coefficients[:, LINEAR:]
    return Cameras(
        rotation=rotation,
        position=-np.linalg.solve(matrices[:, :, :3], matrices[:, :, 3:])[..., 0],
        focal=inner[:, 0, 0],
        aspect=inner[:, 1, 1] / inner[:, 0, 0],
        skew=inner[:, 0, 1] / inner[:, 0, 0],
        centre=inner[:, :2, 2],
        distortion=distortion,
    )


def coefficients_of(cameras: Cameras) -> np.ndarray:
    """The 16 coefficients of each camera, (view, 16)."""
    matrix = _projection(cameras)
    linear = (matrix / matrix[:, 2:, 3:]).reshape(-1, 12)[:, :LINEAR]
    return np.concatenate([linear, cameras.distortion], axis=1)


def coefficient_derivatives(cameras: Cameras) -> np.ndarray:
    """Derivatives of the 16 coefficients to the steps of `Cameras.moved`, (view, 16, 16)."""
    matrix, change = _projection(cameras), _projection_derivatives(cameras)
    last, last_change = matrix[:, 2, 3, None, None], change[:, 2, 3, None, None, :]
    quotient = (change - (matrix / last)[..., None] * last_change) / last[..., None]
    derivatives = np.zeros((len(cameras), PARAMETERS, PARAMETERS))
    derivatives[:, :LINEAR] = quotient.reshape(-1, 12, PARAMETERS)[:, :LINEAR]
    derivatives[:, LINEAR:, LINEAR:] = np.eye(PARAMETERS - LINEAR)
    return derivatives


def _residual(coefficients: np.ndarray, points: np.ndarray, image: np.ndarray) -> np.ndarray:
    """Distances in the image, (n,), pixel."""
    matrix = _projection_matrices(coefficients[None])[0]
    local = points @ matrix[:, :3].T + matrix[:, 3]
    return np.asarray(np.linalg.norm(local[:, :2] / local[:, 2:] - image, axis=1))


def _normalisation(points: np.ndarray) -> np.ndarray:
    """The homogeneous transformation to mean 0 and root mean square 1 along each axis on average."""
    mean = points.mean(axis=0)
    scale = 1.0 / np.sqrt(np.mean((points - mean) ** 2))
    matrix = np.diag([scale] * len(mean) + [1.0])
    matrix[:-1, -1] = -scale * mean
    return matrix


def _transformed(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    return np.asarray(points @ matrix[:-1, :-1].T + matrix[:-1, -1])


def _equations(points: np.ndarray, image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two rows for each point: L1 X + ... + L4 - u (L9 X + L10 Y + L11 Z) = u, and the same for v."""
    matrix = np.zeros((len(points), 2, LINEAR))
    for row in (0, 1):
        matrix[:, row, 4 * row : 4 * row + 3] = points
        matrix[:, row, 4 * row + 3] = 1.0
    matrix[:, :, 8:] = -image[:, :, None] * points[:, None, :]
    return matrix.reshape(-1, LINEAR), image.ravel()


def _projection_matrices(coefficients: np.ndarray) -> np.ndarray:
    linear = coefficients[:, :LINEAR]
    return np.concatenate([linear, np.ones((len(linear), 1))], axis=1).reshape(-1, 3, 4)


def _decomposed(matrix: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """K (upper triangle, its last entry 1) and R of one projection matrix K R [1, -C], `inside` in front of the camera."""
    sign = np.sign(matrix[2] @ np.append(inside, 1.0))
    inner, rotation = rq(sign * matrix[:, :3])
    signs = np.sign(np.diag(inner))
    inner, rotation = inner * signs, signs[:, None] * rotation
    if np.linalg.det(rotation) < 0.0:  # an image whose v points up
        inner[:, 1], rotation[1] = -inner[:, 1], -rotation[1]
    return inner / inner[2, 2], rotation


def _inner(cameras: Cameras) -> np.ndarray:
    """K, (view, 3, 3)."""
    inner = np.zeros((len(cameras), 3, 3))
    inner[:, 0, 0] = cameras.focal
    inner[:, 0, 1] = cameras.focal * cameras.skew
    inner[:, 1, 1] = cameras.focal * cameras.aspect
    inner[:, :2, 2] = cameras.centre
    inner[:, 2, 2] = 1.0
    return inner


def _placed(cameras: Cameras) -> np.ndarray:
    """R [1, -C], (view, 3, 4)."""
    offset = -(cameras.rotation @ cameras.position[..., None])
    return np.concatenate([cameras.rotation, offset], axis=2)


def _projection(cameras: Cameras) -> np.ndarray:
    return np.asarray(_inner(cameras) @ _placed(cameras))


def _projection_derivatives(cameras: Cameras) -> np.ndarray:
    """Derivatives of K R [1, -C] to the steps of `Cameras.moved`, (view, 3, 4, 16)."""
    inner, placed = _inner(cameras), _placed(cameras)
    change = np.zeros((len(cameras), 3, 4, PARAMETERS))
    turns = cross_matrix(np.eye(3))
    for axis in range(3):
        change[..., axis] = inner @ turns[axis] @ placed
        change[:, :, 3, 3 + axis] = -(inner @ cameras.rotation[:, :, axis, None])[..., 0]
    for column, entries in ((6, ((0, 0), (0, 1), (1, 1))), (7, ((1, 1),))):
        for row, entry in entries:
            change[:, row, :, column] += inner[:, row, entry, None] * placed[:, entry]
    change[:, 0, :, 8] = cameras.focal[:, None] * placed[:, 1]
    change[:, 0, :, 9] = change[:, 1, :, 10] = placed[:, 2]
    return change
