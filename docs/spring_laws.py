"""Writes the reference of the installed spring laws into spring-laws.md, below its mark: `python docs/spring_laws.py`."""

from pathlib import Path

from crashkit.registry.describe import describe_laws
from crashkit_spring_laws import SPRING_LAWS

PAGE = Path(__file__).with_name("spring-laws.md")
MARK = "<!-- below this line: written by spring_laws.py -->\n"


def page() -> str:
    """The page as it should be."""
    return PAGE.read_text(encoding="utf-8").split(MARK)[0] + MARK + "\n" + describe_laws(SPRING_LAWS)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
