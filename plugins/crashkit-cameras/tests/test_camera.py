import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit_cameras import Camera
