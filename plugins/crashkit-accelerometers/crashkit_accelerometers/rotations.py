"""Small vectors and matrices of rotations; every function works along the leading dims."""

import numpy as np
from scipy.spatial.transform import Rotation


def cross_matrix(vector: np.ndarray) -> np.ndarray:
    """[v] with [v] w = v x w, (..., 3) to (..., 3, 3)."""
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vector.shape, 3)


def matrices(orientation: np.ndarray) -> np.ndarray:
    """Rotation matrices of unit quaternions (w, x, y, z), (..., 4) to (..., 3, 3)."""
    flat = Rotation.from_quat(orientation.reshape(-1, 4), scalar_first=True).as_matrix()
    return np.asarray(flat).reshape(*orientation.shape[:-1], 3, 3)


def turned(vector: np.ndarray) -> np.ndarray:
    """Rotation matrices of rotation vectors, (..., 3) to (..., 3, 3)."""
    return np.asarray(Rotation.from_rotvec(vector.reshape(-1, 3)).as_matrix()).reshape(*vector.shape, 3)


def left_jacobian(vector: np.ndarray) -> np.ndarray:
    """J with R(v + dv) = R(J dv) R(v) for small dv, (..., 3) to (..., 3, 3).

    J = I + (1 - cos a) / a^2 [v] + (a - sin a) / a^3 [v]^2 with a = |v|.
    """
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    matrix = cross_matrix(vector)
    half = np.sinc(angle / (2.0 * np.pi))
    with np.errstate(divide="ignore", invalid="ignore"):
        cube = np.where(angle > 1e-2, (angle - np.sin(angle)) / angle**3, 1.0 / 6.0 - angle**2 / 120.0)
    return np.eye(3) + 0.5 * half**2 * matrix + cube * (matrix @ matrix)
