"""The loader, with distributions that are nothing but a folder on the path."""

import re
import sys
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator
from crashkit.misfit.together import check_runs
from crashkit.model.checks import model_faults
from crashkit.registry import Registry, load
from crashkit.registry.kinds import KINDS
from crashkit.testing import toys

Install = Callable[..., None]

LAW = """
from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.registry import hookimpl


class {cls}(SpringLaw):
    name = "{name}"
    parameters = (ParameterSpec("stiffness", "N m-1", "slope"),)

    @staticmethod
    def force(d, ddot, d_max, stiffness):
        return stiffness * d


@hookimpl
def crashkit_spring_laws():
    return [{cls}]
"""

LASER = """
from crashkit_cameras import Film
from crashkit.registry import hookimpl


class Laser(Film):
    name = "laser"


@hookimpl
def crashkit_observers():
    return [Laser]
"""


def law(name: str, cls: str = "Linear") -> str:
    return LAW.format(name=name, cls=cls)


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that Python looks for modules and distributions in; the modules are forgotten afterwards."""
    before = set(sys.modules)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in set(sys.modules) - before:
        if (getattr(sys.modules[name], "__file__", None) or "").startswith(str(tmp_path)):
            del sys.modules[name]


@pytest.fixture
def install(path: Path) -> Install:
    """Installs a fake distribution with one entry point for its module of hooks."""

    def install(distribution: str, source: str | None, version: str = "1.0", entry_point: str | None = None) -> None:
        module = distribution.replace("-", "_")
        info = path / f"{module}-{version}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n")
        (info / "entry_points.txt").write_text(f"[crashkit]\n{entry_point or distribution} = {module}\n")
        if source is not None:
            (path / f"{module}.py").write_text(source)

    return install


@pytest.fixture
def installed(path: Path) -> Callable[[], Registry]:
    """Loads the fake distributions only."""

    def fake(entry_point: metadata.EntryPoint) -> bool:
        return Path(str(entry_point.dist.locate_file(""))) == path

    return lambda: load(filter(fake, metadata.entry_points(group="crashkit")))


def reasons(registry: Registry) -> list[str]:
    return [str(failure) for failure in registry.failures]


def test_lists_what_a_distribution_brings(install, installed):
    install("acme-laws", law("linear"), version="2.3")
    (plugin,) = installed().plugins
    assert (plugin.kind, plugin.name, plugin.distribution, plugin.version) == ("spring law", "linear", "acme-laws", "2.3")
    assert installed().spring_laws == {"linear": plugin.implementation}
    assert installed().failures == ()


def test_the_order_is_that_of_the_distributions_names(install, installed):
    for name in ("zeta", "alpha", "Mid"):
        install(name, law(name))
    assert [plugin.distribution for plugin in installed().plugins] == ["alpha", "Mid", "zeta"]


FAULTS = {
    "misspelt hook": (
        law("linear").replace("crashkit_spring_laws", "crashkit_spring_law"),
        "bad 0.9: unknown hook crashkit_spring_law: expected one of crashkit_spring_laws, crashkit_observers, "
        "crashkit_smoothers, crashkit_identifiers, crashkit_hypotheses, crashkit_importers",
    ),
    "forgotten hookimpl": (
        law("linear").replace("@hookimpl", ""),
        "bad 0.9: bad has no hooks: expected functions marked with hookimpl",
    ),
    "syntax error": ("class", "bad 0.9: bad cannot be imported: SyntaxError: invalid syntax (bad.py, line 1)"),
    "missing dependency": (
        "import a_module_that_is_not_there",
        "bad 0.9: bad cannot be imported: ModuleNotFoundError: No module named 'a_module_that_is_not_there'",
    ),
    "exit at import": ("raise SystemExit(3)", "bad 0.9: bad cannot be imported: SystemExit: 3"),
    "no module": (None, "bad 0.9: bad cannot be imported: ModuleNotFoundError: No module named 'bad'"),
    "hook that raises": (
        law("linear").replace("return [Linear]", "raise ValueError('two\\nlines')"),
        "bad 0.9: its hook crashkit_spring_laws failed: ValueError: two lines",
    ),
    "hook that returns nothing": (
        law("linear").replace("return [Linear]", "return None"),
        "bad 0.9: its hook crashkit_spring_laws returned None: expected a list of classes",
    ),
    "hook that returns a class": (
        law("linear").replace("return [Linear]", "return 'linear'"),
        "bad 0.9: its hook crashkit_spring_laws returned 'linear': expected a list of classes",
    ),
    "instance in place of a class": (
        law("linear").replace("return [Linear]", "return [7]"),
        "bad 0.9: 7: expected a subclass of SpringLaw",
    ),
    "wrong kind": (
        law("linear").replace("crashkit_spring_laws", "crashkit_smoothers"),
        "bad 0.9: bad.Linear: expected a subclass of Smoother",
    ),
    "attribute not declared": (
        law("linear").replace('    name = "linear"\n', "").replace("    parameters", "    params"),
        "bad 0.9: bad.Linear: expected name, parameters, which SpringLaw requires and it does not define",
    ),
    "abstract method": (
        """
from crashkit.protocols import Smoother
from crashkit.registry import hookimpl

class Lazy(Smoother):
    name = "lazy"
    degree = 1

@hookimpl
def crashkit_smoothers():
    return [Lazy]
""",
        "bad 0.9: bad.Lazy: expected smooth, which Smoother requires and it does not define",
    ),
    "name that is no text": (
        law("linear").replace('"linear"', "5"),
        "bad 0.9: bad.Linear: expected name to be a text, found 5",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_named_and_the_rest_keeps_working(install, installed, fault):
    source, reason = FAULTS[fault]
    install("bad", source, version="0.9")
    install("good", law("linear"))
    assert reasons(installed()) == [reason]
    assert list(installed().spring_laws) == ["linear"]


def test_a_hook_that_takes_arguments_is_refused(install, installed):
    install("bad", law("linear").replace("crashkit_spring_laws()", "crashkit_spring_laws(model)"))
    (failure,) = installed().failures
    assert failure.reason.startswith(
        "bad cannot be imported: PluginValidationError: Plugin 'bad' for hook 'crashkit_spring_laws'"
    )
    assert "{'model'}" in failure.reason


def test_only_the_faulty_class_of_a_plugin_is_refused(install, installed):
    install("half", law("linear").replace("return [Linear]", "return [Linear, int]"))
    assert list(installed().spring_laws) == ["linear"]
    assert reasons(installed()) == ["half 1.0: builtins.int: expected a subclass of SpringLaw"]


def test_a_name_that_two_distributions_claim_is_refused_to_both(install, installed):
    install("acme", law("linear", "AcmeLinear"))
    install("zeta", law("linear", "ZetaLinear"), version="2.0")
    install("other", law("other"))
    assert list(installed().spring_laws) == ["other"]
    assert reasons(installed()) == [
        'acme 1.0: acme.AcmeLinear is called spring law "linear" as is zeta.ZetaLinear of zeta 2.0: '
        "neither is used, rename or uninstall one",
        'zeta 2.0: zeta.ZetaLinear is called spring law "linear" as is acme.AcmeLinear of acme 1.0: '
        "neither is used, rename or uninstall one",
    ]


def test_a_name_that_two_distributions_claim_is_told_where_it_is_used(install, installed):
    install("acme", law("linear", "AcmeLinear"))
    install("zeta", law("linear", "ZetaLinear"), version="2.0")
    install("other", law("lineal"))
    claim = r"\(claimed by acme.AcmeLinear of acme 1.0 and zeta.ZetaLinear of zeta 2.0: rename or uninstall one\)"
    with pytest.raises(CrashkitError, match=rf'^no spring law "linear" is installed {claim} \(2 plugins failed to load: '):
        installed().spring_law("linear")
    model = toys.one_degree()
    for name in ("linear", "lineal + linear"):
        clashing = evolve(model, joints=(evolve(model.joints[0], law=name),))
        faults = [str(fault) for fault in model_faults(clashing, installed().spring_laws)]
        assert re.fullmatch(rf'joint "first"/law: expected one of the installed laws, found "linear" {claim}', faults[0])


def test_an_observer_that_two_distributions_claim_is_told_where_it_is_used(install, installed):
    model = toys.one_degree()
    tree = toys.recording(Simulator(model, load().spring_laws).run(np.linspace(0.0, 0.01, 11)))
    tree["film"].attrs["observer"] = "laser"
    for name in ("acme", "zeta"):
        install(name, LASER)
    found = r"found laser \(claimed by acme.Laser of acme 1.0 and zeta.Laser of zeta 1.0: rename or uninstall one\)"
    with pytest.raises(CrashkitError, match=rf"^run: film: expected an installed observer \(\), {found}$"):
        check_runs(model, {"run": tree}, installed().observers)


def test_an_entry_point_of_two_distributions_belongs_to_the_one_that_bears_its_name(install, installed):
    install("acme-laws", law("linear"))
    install("a-copy", law("copied"), version="0.1", entry_point="acme-laws")
    assert list(installed().spring_laws) == ["linear"]
    assert reasons(installed()) == [
        'a-copy 0.1: its entry point "acme-laws" is also declared by acme-laws 1.0: expected the name of its distribution'
    ]


def test_an_entry_point_of_two_distributions_that_neither_bears_is_refused_to_both(install, installed):
    install("one", law("first"), entry_point="laws")
    install("two", law("second"), entry_point="laws")
    install("three", law("third"))
    assert list(installed().spring_laws) == ["third"]
    assert reasons(installed()) == [
        'one 1.0: its entry point "laws" is also declared by two 1.0: expected the name of its distribution',
        'two 1.0: its entry point "laws" is also declared by one 1.0: expected the name of its distribution',
    ]


def test_what_is_not_installed_is_refused_with_what_is(install, installed):
    install("acme", law("linear"))
    message = '^no spring law "cubic" is installed, expected one of linear$'
    with pytest.raises(CrashkitError, match=message):
        installed().spring_law("cubic")
    assert installed().spring_law("linear").name == "linear"


def test_a_misspelt_name_is_told_its_neighbour(install, installed):
    install("acme", law("linear"))
    with pytest.raises(CrashkitError, match=r'^no spring law "lineer" is installed \(did you mean "linear"\?\)$'):
        installed().spring_law("lineer")


def test_python_shows_how_many_of_each_kind_there_are(install, installed):
    install("acme", law("linear"))
    install("bad", "import a_module_that_is_not_there")
    assert repr(installed()) == "registry of 1 plugin, 1 failure\n  spring law: 1"


def test_what_is_not_installed_is_refused_with_a_word_on_failures(install, installed):
    install("acme", "import a_module_that_is_not_there")
    message = (
        '^no spring law "linear" is installed, expected none, as nothing of the kind is installed '
        r"\(1 plugin failed to load: run `crashkit plugins`\)$"
    )
    with pytest.raises(CrashkitError, match=message):
        installed().spring_law("linear")


@pytest.mark.parametrize("kind", ["observer", "smoother", "identifier", "hypothesis", "importer"])
def test_every_kind_has_its_accessor(installed, kind):
    with pytest.raises(CrashkitError, match=f'^no {kind} "x" is installed'):
        getattr(installed(), kind)("x")


def test_the_installed_plugins_are_loaded_once_and_without_a_failure():
    assert load() is load()
    assert [str(failure) for failure in load().failures] == []


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.title)
def test_every_kind_is_installed_and_found_by_its_accessor(kind):
    names = [plugin.name for plugin in load().plugins if plugin.kind == kind.title]
    assert names
    for name in names:
        assert issubclass(getattr(load(), kind.title.replace(" ", "_"))(name), kind.base)
