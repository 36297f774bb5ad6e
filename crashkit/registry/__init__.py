"""The registry: every plugin that is installed, loaded strictly and reported kindly."""

from crashkit.registry.hookspecs import hookimpl
from crashkit.registry.loader import load
from crashkit.registry.registry import Failure, Plugin, Registry

__all__ = ["Failure", "Plugin", "Registry", "hookimpl", "load"]
