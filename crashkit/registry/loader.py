"""The loader: strict about what a plugin returns, kind about one that fails.

pluggy alone passes over a misspelt hook and a second distribution with the same entry-point name, and one plugin that cannot
be imported stops all others. Here each plugin has a manager of its own, and the smallest thing at fault is refused, with a
reason.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib import metadata
from importlib.metadata import EntryPoint
from typing import Any

from attrs import frozen
from pluggy import PluginManager

from crashkit.errors import one_line
from crashkit.registry import hookspecs
from crashkit.registry.kinds import KINDS, Kind
from crashkit.registry.registry import Failure, Plugin, Registry, class_name

GROUP = "crashkit"


def load(entry_points: Iterable[EntryPoint] | None = None) -> Registry:
    """Load every plugin, never raising for one that fails.

    Arguments:
        entry_points: of the plugins; None: those that are installed, loaded once in a process.

    Returns:
        the registry, with a failure for everything that was refused.
    """
    return _installed() if entry_points is None else _load(entry_points)


@cache
def _installed() -> Registry:
    return _load(metadata.entry_points(group=GROUP))


def _load(entry_points: Iterable[EntryPoint]) -> Registry:
    sources = sorted((_Source.of(entry_point) for entry_point in entry_points), key=lambda source: source.order)
    found: list[Plugin | Failure] = [*_entry_point_clashes(sources)]
    for source in sources:
        if _owns_its_entry_point(source, sources):
            found += _read(source)
    plugins = [item for item in found if isinstance(item, Plugin)]
    clashes = list(_name_clashes(plugins))
    failures = [item for item in found if isinstance(item, Failure)] + [failure for _, failure in clashes]
    refused = [plugin for plugin, _ in clashes]
    return Registry(tuple(plugin for plugin in plugins if plugin not in refused), tuple(failures), tuple(refused))


@frozen
class _Source:
    """An entry point and the distribution that declares it."""

    entry_point: EntryPoint
    distribution: str
    version: str

    @classmethod
    def of(cls, entry_point: EntryPoint) -> "_Source":
        if entry_point.dist is None:
            return cls(entry_point, "unknown", "unknown")
        return cls(entry_point, entry_point.dist.name, entry_point.dist.version)

    @property
    def order(self) -> tuple[str, str]:
        return _normalised(self.distribution), self.entry_point.name

    def failure(self, reason: str) -> Failure:
        return Failure(self.distribution, self.version, reason)

    def plugin(self, kind: Kind, implementation: type) -> Plugin:
        return Plugin(kind.title, getattr(implementation, kind.label), self.distribution, self.version, implementation)


def _normalised(distribution: str) -> str:
    return distribution.lower().replace("_", "-").replace(".", "-")


def _rivals(source: _Source, sources: Iterable[_Source]) -> list[_Source]:
    return [other for other in sources if other is not source and other.entry_point.name == source.entry_point.name]


def _owns_its_entry_point(source: _Source, sources: Iterable[_Source]) -> bool:
    """An entry point that two distributions declare belongs to the one that bears its name, else to none."""
    return _normalised(source.distribution) == _normalised(source.entry_point.name) or not _rivals(source, sources)


def _entry_point_clashes(sources: list[_Source]) -> Iterator[Failure]:
    for source in sources:
        if not _owns_its_entry_point(source, sources):
            others = " and ".join(f"{other.distribution} {other.version}" for other in _rivals(source, sources))
            reason = f'its entry point "{source.entry_point.name}" is also declared by {others}'
            yield source.failure(f"{reason}: expected the name of its distribution")


def _read(source: _Source) -> Iterator[Plugin | Failure]:
    """What the hooks of one plugin return, and every fault in it."""
    manager = PluginManager("crashkit")
    manager.add_hookspecs(hookspecs)
    try:
        module = source.entry_point.load()
        manager.register(module)
    except (Exception, SystemExit) as error:
        yield source.failure(f"{source.entry_point.value} cannot be imported: {one_line(error)}")
        return
    callers = manager.get_hookcallers(module) or []
    if not callers:
        yield source.failure(f"{source.entry_point.value} has no hooks: expected functions marked with hookimpl")
    kinds = {kind.hook: kind for kind in KINDS}
    for caller in callers:
        for implementation in caller.get_hookimpls():
            if caller.name in kinds:
                yield from _call(source, kinds[caller.name], implementation.function)
            else:
                yield source.failure(f"unknown hook {caller.name}: expected one of {', '.join(kinds)}")


def _call(source: _Source, kind: Kind, hook: Callable[[], Any]) -> Iterator[Plugin | Failure]:
    try:
        classes = hook()
    except (Exception, SystemExit) as error:
        yield source.failure(f"its hook {kind.hook} failed: {one_line(error)}")
        return
    if not isinstance(classes, list):
        yield source.failure(f"its hook {kind.hook} returned {classes!r}: expected a list of classes")
        return
    for item in classes:
        fault = _fault(kind, item)
        yield source.failure(f"{class_name(item)}: {fault}") if fault else source.plugin(kind, item)


def _fault(kind: Kind, item: object) -> str:
    """Why this is no implementation of its kind; empty where it is one."""
    if not (isinstance(item, type) and issubclass(item, kind.base)):
        return f"expected a subclass of {kind.base.__name__}"
    missing = [name for name in _declared(kind.base) if not hasattr(item, name)]
    missing += sorted(getattr(item, "__abstractmethods__", ()))
    if missing:
        return f"expected {', '.join(missing)}, which {kind.base.__name__} requires and it does not define"
    name = getattr(item, kind.label)
    return "" if isinstance(name, str) and name else f"expected {kind.label} to be a text, found {name!r}"


def _declared(base: type) -> Iterator[str]:
    """Class attributes that the abstract class declares without a value."""
    return (name for name in base.__annotations__ if not hasattr(base, name))


def _name_clashes(plugins: Iterable[Plugin]) -> Iterator[tuple[Plugin, Failure]]:
    """Plugins of one kind that share a name: all are refused, as a model that names it would have two meanings."""
    groups: defaultdict[tuple[str, str], list[Plugin]] = defaultdict(list)
    for plugin in plugins:
        groups[plugin.kind, plugin.name].append(plugin)
    for (kind, name), group in groups.items():
        for plugin in group:
            others = " and ".join(str(other) for other in group if other is not plugin)
            if others:
                claim = f'{class_name(plugin.implementation)} is called {kind} "{name}" as is {others}'
                yield (
                    plugin,
                    Failure(plugin.distribution, plugin.version, f"{claim}: neither is used, rename or uninstall one"),
                )
