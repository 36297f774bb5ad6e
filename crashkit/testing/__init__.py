"""What plugin authors test with: contract suites, and toys with known answers.

A contract is a class of tests: subclass it in a test file under a name that begins with Test, and give it what it asks for.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crashkit.testing.hypothesis_contract import HypothesisContract
    from crashkit.testing.identifier_contract import IdentifierContract
    from crashkit.testing.observer_contract import ObserverContract
    from crashkit.testing.smoother_contract import SmootherContract
    from crashkit.testing.spring_law_contract import SpringLawContract

__all__ = ["HypothesisContract", "IdentifierContract", "ObserverContract", "SmootherContract", "SpringLawContract"]

_HOME = {
    "HypothesisContract": "hypothesis_contract",
    "IdentifierContract": "identifier_contract",
    "ObserverContract": "observer_contract",
    "SmootherContract": "smoother_contract",
    "SpringLawContract": "spring_law_contract",
}


def __getattr__(name: str) -> object:
    """Import a contract when it is asked for: it needs pytest, the toys do not."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
