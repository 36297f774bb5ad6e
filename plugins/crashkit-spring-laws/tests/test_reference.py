"""The reference in the documentation holds all that the laws declare."""

import math
from pathlib import Path

import pytest

from crashkit_spring_laws import SPRING_LAWS

PAGE = Path(__file__).parents[3] / "docs" / "spring-laws.md"
DECLARED = [pytest.param(law, spec, id=f"{law.name}.{spec.name}") for law in SPRING_LAWS for spec in law.parameters]


@pytest.mark.parametrize(("law", "spec"), DECLARED)
def test_a_parameter_is_there_with_unit_meaning_bounds_and_default(law, spec):
    section = PAGE.read_text(encoding="utf-8").split(f"\n### {law.name}\n")[1].split("\n#")[0]
    rows = [line for line in section.splitlines() if line.startswith(f"| `{spec.name}`")]
    assert len(rows) == 1
    _, name, unit, meaning, bounds, omitted, _ = (cell.strip() for cell in rows[0].replace("\\|", "/").split("|"))
    assert unit == spec.unit
    assert meaning == spec.meaning.replace("|", "/")
    assert ("a list" in name) == spec.vector
    assert ("fixed unless freed" in bounds) != spec.free
    for bound in (spec.lower, spec.upper):
        assert math.isinf(bound) or f"{bound:g}" in bounds.split(";")[0].split()
    assert omitted == ("must be given" if spec.default is None else f"{spec.default:g}")


@pytest.mark.parametrize("law", SPRING_LAWS, ids=lambda law: law.name)
def test_a_law_is_there_with_its_equation(law):
    section = PAGE.read_text(encoding="utf-8").split(f"\n### {law.name}\n")[1].split("\n#")[0]
    assert law.__doc__.splitlines()[0] in section
