"""The functions that a law may call, with their derivatives."""

import builtins
import math

import numpy as np

DERIVATIVES = {
    "sqrt": "0.5 / {y}",
    "exp": "{y}",
    "expm1": "{y} + 1.0",
    "log": "1.0 / {x}",
    "log1p": "1.0 / (1.0 + {x})",
    "sin": "math.cos({x})",
    "cos": "-math.sin({x})",
    "tan": "1.0 + {y} * {y}",
    "asin": "1.0 / math.sqrt(1.0 - {x} * {x})",
    "acos": "-1.0 / math.sqrt(1.0 - {x} * {x})",
    "atan": "1.0 / (1.0 + {x} * {x})",
    "sinh": "math.cosh({x})",
    "cosh": "math.sinh({x})",
    "tanh": "1.0 - {y} * {y}",
    "erf": "1.1283791670955126 * math.exp(-{x} * {x})",
}
"""Derivative of each function of `math` as source, with {x} its argument and {y} its value, both variables."""

NUMPY = {"asin": "arcsin", "acos": "arccos", "atan": "arctan"}

NAMES = (
    {getattr(math, name): name for name in DERIVATIVES}
    | {getattr(np, NUMPY.get(name, name)): name for name in DERIVATIVES if name != "erf"}
    | {getattr(builtins, name): name for name in ("min", "max", "abs", "len", "float")}
    | {math.fabs: "abs", np.abs: "abs", np.minimum: "min", np.maximum: "max"}
)
"""What a law may call: the functions of `math`, of numpy where they mean the same, and some built-in ones."""
