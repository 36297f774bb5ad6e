"""Registers the identifiers."""

from typing import Any

from crashkit.protocols import Identifier
from crashkit.registry import hookimpl
from crashkit_identifiers.chebyshev import Chebyshev
from crashkit_identifiers.gradient import Gradient
from crashkit_identifiers.integral_filter import IntegralFilter
from crashkit_identifiers.multi_start import MultiStart
from crashkit_identifiers.optimal_control import OptimalControl
from crashkit_identifiers.optimal_filter import OptimalFilter
from crashkit_identifiers.sensitivity import Sensitivity
from crashkit_identifiers.state_form import QuickRegression, StateFormRegression
from crashkit_identifiers.substructuring import Substructuring


@hookimpl
def crashkit_identifiers() -> list[type[Identifier[Any]]]:
    """The identifiers of this distribution."""
    return [
        MultiStart,
        Sensitivity,
        OptimalControl,
        Gradient,
        OptimalFilter,
        IntegralFilter,
        StateFormRegression,
        QuickRegression,
        Chebyshev,
        Substructuring,
    ]
