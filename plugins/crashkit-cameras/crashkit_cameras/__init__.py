"""Observers for film: markers followed by one or several cameras."""

from crashkit_cameras.camera import Camera
from crashkit_cameras.film import Film

__all__ = ["Camera", "Film"]
