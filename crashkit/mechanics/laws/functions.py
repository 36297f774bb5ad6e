"""The functions of `math` that a law may use, with their derivatives."""

DERIVATIVES = {
    "sqrt": "0.5 / math.sqrt({x})",
    "exp": "math.exp({x})",
    "expm1": "math.exp({x})",
    "log": "1.0 / {x}",
    "log1p": "1.0 / (1.0 + {x})",
    "sin": "math.cos({x})",
    "cos": "-math.sin({x})",
    "tan": "1.0 / math.cos({x}) ** 2",
    "asin": "1.0 / math.sqrt(1.0 - {x} * {x})",
    "acos": "-1.0 / math.sqrt(1.0 - {x} * {x})",
    "atan": "1.0 / (1.0 + {x} * {x})",
    "sinh": "math.cosh({x})",
    "cosh": "math.sinh({x})",
    "tanh": "1.0 - math.tanh({x}) ** 2",
    "erf": "1.1283791670955126 * math.exp(-{x} * {x})",
}
"""Derivative of each function as source, with {x} its argument in brackets."""
