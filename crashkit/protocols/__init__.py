"""The protocols: what a plugin implements, one page each."""

from crashkit.protocols.hypothesis import Hypothesis, Proposal
from crashkit.protocols.identifier import Identification, Identifier, Problem, Regression, Status, advanced
from crashkit.protocols.importer import Importer
from crashkit.protocols.observer import Misread, Observer, PlainObserver, Reading, SensorErrors, Shown, TurningReading
from crashkit.protocols.parameter import ParameterSpec
from crashkit.protocols.smoother import Smoother
from crashkit.protocols.spring_law import Laws, SpringLaw

__all__ = [
    "Hypothesis",
    "Identification",
    "Identifier",
    "Importer",
    "Laws",
    "Misread",
    "Observer",
    "ParameterSpec",
    "PlainObserver",
    "Problem",
    "Proposal",
    "Reading",
    "Regression",
    "SensorErrors",
    "Shown",
    "TurningReading",
    "Smoother",
    "SpringLaw",
    "Status",
    "advanced",
]
