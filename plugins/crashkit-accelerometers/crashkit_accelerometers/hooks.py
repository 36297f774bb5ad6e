"""Registers the observers of this distribution."""

from crashkit.protocols import Observer
from crashkit.registry import hookimpl
from crashkit_accelerometers.accelerometer import Accelerometer
from crashkit_accelerometers.load_cell import LoadCell


@hookimpl
def crashkit_observers() -> list[type[Observer]]:
    return [Accelerometer, LoadCell]
