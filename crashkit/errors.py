"""The errors that a user can mend: printed as lines, never as a traceback."""

from collections.abc import Callable, Iterable
from difflib import get_close_matches

from attrs import frozen


class CrashkitError(Exception):
    """An error that a user can mend; the command line prints it and exits with status 2."""


@frozen
class Fault:
    """One thing that is not as the contract says."""

    place: str
    expected: str
    found: str

    def __str__(self) -> str:
        return f"{self.place}: expected {self.expected}, found {self.found}"


class ContractError(CrashkitError):
    """Input that breaks a contract; lists every fault, one line each."""

    def __init__(self, source: str, faults: Iterable[Fault]) -> None:
        self.source = source
        self.faults = tuple(faults)
        super().__init__("\n".join(f"{source}: {fault}" for fault in self.faults))


class SimulationError(CrashkitError):
    """A simulation that could not be carried to its end."""


def raise_together(checks: Iterable[Callable[[], object]]) -> None:
    """Make every check, and raise one CrashkitError with the lines of all that failed."""
    told = []
    for check in checks:
        try:
            check()
        except CrashkitError as error:
            told.append(str(error))
    if told:
        raise CrashkitError("\n".join(told))


def one_line(error: BaseException) -> str:
    """Another's error as part of a message: `ZeroDivisionError: division by zero`."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}".removesuffix(": ")


def did_you_mean(found: str, known: Iterable[str]) -> str:
    """` (did you mean "crush_force"?)` where a known name is close to the one that was found; else nothing."""
    return "".join(f' (did you mean "{name}"?)' for name in get_close_matches(found, list(known), n=1))


def claimed_twice(name: str, installed: object) -> str:
    """` (claimed by acme.Foam of acme 1.0 and zeta.Foam of zeta 2.0: rename or uninstall one)`; else nothing.

    Arguments:
        name: that is not found.
        installed: plugins by name, with those that share a name as its `clashes`, if it knows them.
    """
    claim = getattr(installed, "clashes", {}).get(name)
    return f" (claimed by {claim}: rename or uninstall one)" if claim else ""
