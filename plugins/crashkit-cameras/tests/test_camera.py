import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit_cameras import Camera


def test_a_camera_group_is_described_but_not_yet_reconstructed() -> None:
    assert {"image_position", "control_position", "control_image"} <= {variable.name for variable in Camera.schema.variables}
    with pytest.raises(CrashkitError, match="must be reconstructed into a film group first"):
        Camera().reconstruct(xr.Dataset())
    with pytest.raises(CrashkitError, match="must be reconstructed into a film group first"):
        Camera().predict(xr.Dataset(), xr.Dataset())
