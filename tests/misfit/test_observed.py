"""What an observer does wrong is told in one line that names it."""

import re

import pytest

from crashkit.errors import CrashkitError
from crashkit.misfit import Misfit
from crashkit.protocols import Observer

READ = ("position", "position_sensitivity", "position_error_sensitivity")


@pytest.fixture
def asked(registry, engine, model, recorded, with_errors):
    """Asks a misfit for its Jacobian, with a film whose predictions are changed."""
    film = registry.observer("film")

    def ask(change):
        def predict(self, motion, instrument, errors=None):
            return change(film().predict(motion, instrument, errors))

        attributes = ("name", "schema", "quantity", "channel", "errors", "instrument_errors")
        own = {name: getattr(film, name) for name in attributes}
        kind = type("Own", (Observer,), {**own, "predict": predict, "reconstruct": None})
        watched = with_errors(model, "film", "front_marker", gain=1.01)
        recordings = {"run": recorded(model, end=0.02)}
        misfit = Misfit(watched, recordings, registry.spring_laws, {**registry.observers, "film": kind}, engine)
        return misfit.residual_and_jacobian(misfit.start())[1]

    return ask


def test_an_observer_without_fault(asked):
    assert asked(lambda read: read).shape[1] > 1


FAULTS = {
    "raises": (lambda read: read["velocity"], "predict raised KeyError: "),
    "returns nothing": (lambda read: None, "predict raised AttributeError: "),
    **{f"without {name}": (lambda read, name=name: read.drop_vars(name), f"expected {name} (time 21, ") for name in READ},
    "transposed": (
        lambda read: read.transpose("axis", "marker", "time", ...),
        "expected position (time 21, marker 1, axis 1) of predict, found (axis 1, marker 1, time 21)",
    ),
    "transposed sensitivities": (
        lambda read: read.assign(position_sensitivity=read["position_sensitivity"].transpose("parameter", ...)),
        "expected position_sensitivity (time 21, marker 1, axis 1, parameter) of predict, found (parameter ",
    ),
    "too short": (
        lambda read: read.isel(time=slice(20)),
        "expected position (time 21, marker 1, axis 1) of predict, found (time 20, marker 1, axis 1)",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_an_observer_names_it(asked, fault):
    change, message = FAULTS[fault]
    with pytest.raises(CrashkitError, match=f"^run/film: observer film: {re.escape(message)}.*$"):
        asked(change)


def test_what_an_observer_refuses_itself_is_told_as_it_says(asked):
    def refuse(read):
        raise CrashkitError("film: expected two markers, found one")

    with pytest.raises(CrashkitError, match="^film: expected two markers, found one$"):
        asked(refuse)
