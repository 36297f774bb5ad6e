"""Mechanics: bodies and joints in motion, simulated by one compiled engine with exact sensitivities."""

from crashkit.mechanics.engine import Engine, compile_engine
from crashkit.mechanics.ensemble import simulate_many
from crashkit.mechanics.laws.emit import can_be_derived
from crashkit.mechanics.laws.source import LawFunction
from crashkit.mechanics.layout import functions_of
from crashkit.mechanics.simulator import Simulator, simulate

__all__ = [
    "Engine",
    "LawFunction",
    "Simulator",
    "can_be_derived",
    "compile_engine",
    "functions_of",
    "simulate",
    "simulate_many",
]
