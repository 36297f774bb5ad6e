"""The report: a page for people and a document for programs, from a Diagnosis alone."""

from crashkit.report.document import diagnosis_json, write_curves, write_json
from crashkit.report.page import write_report

__all__ = ["diagnosis_json", "write_curves", "write_json", "write_report"]
