"""The reference of spring laws is what the laws declare."""

import re
import runpy
from pathlib import Path

import pytest

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.registry.describe import describe_law, describe_laws
from crashkit_spring_laws import SPRING_LAWS

DOCS = Path(__file__).parents[2] / "docs"


class Odd(SpringLaw):
    """One of everything: F = k d."""

    name = "odd"
    passive = False
    jumps = True
    memory = "z"
    parameters = (
        ParameterSpec("k", "N m-1", "slope, |k|", lower=1.0),
        ParameterSpec("v", "1", "numbers", upper=2.0, vector=True, free=False),
        ParameterSpec("share", "1", "share", lower=0.0, upper=1.0, default=0.5),
    )


def test_a_law_as_a_section():
    assert describe_law(Odd) == (
        "### odd\n\nOne of everything: F = k d.\n\n"
        "It has the memory `z`; jumps; may give out more energy than it took in.\n\n"
        "| parameter | unit | meaning | bounds | if omitted |\n"
        "| --- | --- | --- | --- | --- |\n"
        "| `k` | N m-1 | slope, \\|k\\| | 1 or more | must be given |\n"
        "| `v`, a list | 1 | numbers | 2 or less; fixed unless freed | must be given |\n"
        "| `share` | 1 | share | 0 to 1 | 0.5 |\n"
    )


def test_laws_come_before_factors():
    text = describe_laws(SPRING_LAWS)
    assert text.index("## Laws") < text.index("### tie") < text.index("## Factors") < text.index("### rate_power")


def test_the_page_is_up_to_date():
    written = runpy.run_path(str(DOCS / "spring_laws.py"))
    assert (DOCS / "spring-laws.md").read_text(encoding="utf-8") == written["page"](), "run python docs/spring_laws.py"


@pytest.mark.parametrize("law", SPRING_LAWS, ids=lambda law: law.name)
def test_the_page_names_every_law_to_choose_from(law):
    choice = (DOCS / "spring-laws.md").read_text(encoding="utf-8").split("<!--")[0]
    assert re.search(rf"`[^`]*\b{law.name}`", choice.split("## Which one?")[1])
