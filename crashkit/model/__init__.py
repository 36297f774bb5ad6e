"""The model: frozen bodies, joints and instrument errors, with TOML and Dataset round trips."""

from crashkit.model.body import Body
from crashkit.model.given import GivenForce, GivenMotion
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import KnownSum, Parameter

__all__ = ["Body", "GivenForce", "GivenMotion", "InstrumentErrors", "Joint", "KnownSum", "Model", "Parameter"]
