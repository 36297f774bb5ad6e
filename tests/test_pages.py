"""What the pages promise about an edit of the example law is what happens."""

import importlib.util
import re
import sys
from pathlib import Path

import pytest

from crashkit.testing import SpringLawContract
from crashkit.testing.spring_law_probe import Probe

CHECKOUT = Path(__file__).parent.parent
LAW = CHECKOUT / "plugins" / "crashkit-example-law" / "crashkit_example_law" / "hardening.py"
PAGE = CHECKOUT / "docs" / "write-a-spring-law.md"
PARAMETERS = {"stiffness": 1e5, "hardening": 2e6, "loss": 0.5}
"""Of the page's own test."""


def law_after(edit: str, folder: Path) -> type:
    """The example law with another last line."""
    text = re.sub(r"loading - loss \* \(peak - loading\)(?=\)\n)", edit, LAW.read_text(encoding="utf-8"))
    (folder / "hardening_edited.py").write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("hardening_edited", folder / "hardening_edited.py")
    module = sys.modules["hardening_edited"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Hardening


def test_the_edit_that_the_page_tells_is_caught_in_the_words_that_it_tells(tmp_path):
    page = PAGE.read_text(encoding="utf-8")
    edit = re.search(r"Write `([^`]+)` in the last line of `force`", page).group(1)
    message = re.search(r"```text\n(hardening gave out .*)\n```", page).group(1)
    law = law_after(edit, tmp_path)
    with pytest.raises(AssertionError, match=f"^{re.escape(message)}"):
        SpringLawContract().test_a_passive_law_gives_out_no_more_energy_than_it_took_in(law, Probe(law, PARAMETERS))
