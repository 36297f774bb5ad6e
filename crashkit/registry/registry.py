"""What is installed, by kind and name, and what failed to load."""

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from attrs import frozen

from crashkit.errors import CrashkitError, claimed_twice, did_you_mean
from crashkit.protocols import Hypothesis, Identifier, Importer, Observer, Regression, Smoother, SpringLaw
from crashkit.registry.law_book import LawBook

Base = TypeVar("Base")


@frozen
class Plugin:
    """A class that is installed: its kind and name, and the distribution that brought it."""

    kind: str
    name: str
    distribution: str
    version: str
    implementation: type

    def __str__(self) -> str:
        return f"{class_name(self.implementation)} of {self.distribution} {self.version}"


@frozen
class Failure:
    """Something of a distribution that was refused, and why."""

    distribution: str
    version: str
    reason: str

    def __str__(self) -> str:
        return f"{self.distribution} {self.version}: {self.reason}"


class Installed(dict[str, type[Base]]):
    """Plugins of one kind by name; `clashes` tells of a name that several claim, so that none is used, who they are."""

    def __init__(self, plugins: Iterable[Plugin], clashing: Iterable[Plugin]) -> None:
        super().__init__({plugin.name: plugin.implementation for plugin in plugins})
        self.clashes: dict[str, str] = {}
        for plugin in clashing:
            self.clashes[plugin.name] = " and ".join(filter(None, [self.clashes.get(plugin.name), str(plugin)]))


@frozen(repr=False)
class Registry:
    """Every plugin that loaded and every failure, in the order of their distributions' names; and the plugins that are
    refused, as they share a name."""

    plugins: tuple[Plugin, ...]
    failures: tuple[Failure, ...]
    clashing: tuple[Plugin, ...] = ()

    def __repr__(self) -> str:
        counts = Counter(plugin.kind for plugin in self.plugins)
        head = f"registry of {plural(len(self.plugins), 'plugin')}, {plural(len(self.failures), 'failure')}"
        return "\n".join([head, *(f"  {kind}: {count}" for kind, count in counts.items())])

    @property
    def spring_laws(self) -> LawBook:
        """Laws and factors by name, and sums of laws."""
        return LawBook(self._named(SpringLaw))

    @property
    def observers(self) -> dict[str, type[Observer]]:
        """Instruments by name."""
        return self._named(Observer)

    @property
    def smoothers(self) -> dict[str, type[Smoother]]:
        """Smoothers by name."""
        return self._named(Smoother)

    @property
    def identifiers(self) -> dict[str, type[Identifier[Any]]]:
        """Methods of identification by name."""
        return self._named(Identifier)

    @property
    def hypotheses(self) -> dict[str, type[Hypothesis]]:
        """Hypotheses by the name of their physics."""
        return self._named(Hypothesis)

    @property
    def importers(self) -> dict[str, type[Importer]]:
        """Importers by the name of their format."""
        return self._named(Importer)

    def spring_law(self, name: str) -> type[SpringLaw]:
        """The law or factor of that name; raises CrashkitError where it is not installed."""
        return self._find("spring law", self.spring_laws, name)

    def observer(self, name: str) -> type[Observer]:
        """The instrument of that name; raises CrashkitError where it is not installed."""
        return self._find("observer", self.observers, name)

    def smoother(self, name: str) -> type[Smoother]:
        """The smoother of that name; raises CrashkitError where it is not installed."""
        return self._find("smoother", self.smoothers, name)

    def identifier(self, name: str) -> type[Identifier[Any]]:
        """The method of that name; raises CrashkitError where it is not installed."""
        return self._find("identifier", self.identifiers, name)

    def regression(self, name: str) -> type[Regression[Any]]:
        """The method of that name that fits equations; raises CrashkitError where it is not installed."""
        methods = {one: kind for one, kind in self.identifiers.items() if issubclass(kind, Regression)}
        return self._find("regression", methods, name)

    def hypothesis(self, physics: str) -> type[Hypothesis]:
        """The hypothesis of that physics; raises CrashkitError where it is not installed."""
        return self._find("hypothesis", self.hypotheses, physics)

    def importer(self, name: str) -> type[Importer]:
        """The importer of that format; raises CrashkitError where it is not installed."""
        return self._find("importer", self.importers, name)

    @property
    def warning(self) -> str:
        """One line that says how many failures there are and where to read them; empty where there are none."""
        distributions = {failure.distribution for failure in self.failures}
        return f"{plural(len(distributions), 'plugin')} failed to load: run `crashkit plugins`" if distributions else ""

    def source_of(self, implementation: type) -> str:
        """The distribution that brought a class; of one that no plugin brought, its module."""
        brought = (plugin.distribution for plugin in self.plugins if plugin.implementation is implementation)
        return next(brought, implementation.__module__)

    def _named(self, base: type[Base]) -> Installed[Base]:
        return Installed(*([p for p in some if issubclass(p.implementation, base)] for some in (self.plugins, self.clashing)))

    def _find(self, kind: str, installed: Mapping[str, type[Base]], name: str) -> type[Base]:
        if name not in installed:
            hint = claimed_twice(name, installed) or did_you_mean(name, installed)
            message = f'no {kind} "{name}" is installed{hint or f", expected {one_of(installed)}"}'
            raise CrashkitError(f"{message} ({self.warning})" if self.failures else message)
        return installed[name]


def class_name(implementation: object) -> str:
    """A class as errors name it, with its module."""
    if not isinstance(implementation, type):
        return repr(implementation)
    return f"{implementation.__module__}.{implementation.__qualname__}"


def one_of(names: Iterable[str]) -> str:
    """Names as an error lists what it expected."""
    known = sorted(names)
    return f"one of {', '.join(known)}" if known else "none, as nothing of the kind is installed"


def plural(count: int, noun: str) -> str:
    """A count with its noun."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
