"""Registers the observers of this distribution."""

from crashkit.protocols import Observer
from crashkit.registry import hookimpl
from crashkit_cameras.camera import Camera
from crashkit_cameras.film import Film


@hookimpl
def crashkit_observers() -> list[type[Observer]]:
    return [Film, Camera]
