"""Find, name, model and prove the physics that a model left out."""

from crashkit.diagnose.diagnosis import diagnose
from crashkit.diagnose.result import Alternative, Diagnosis, Estimate, Finding, Fit
from crashkit.diagnose.workshop import Workshop

__all__ = ["Alternative", "Diagnosis", "Estimate", "Finding", "Fit", "Workshop", "diagnose"]
