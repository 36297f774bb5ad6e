"""What options may be: KEY=VALUE of a plugin, a file of some kind."""

from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path


def pair(text: str) -> tuple[str, str]:
    """The key and the value; raises ArgumentTypeError where there is none."""
    key, equals, value = text.partition("=")
    if not (key and equals):
        raise ArgumentTypeError(f"expected KEY=VALUE, found {text!r}")
    return key, value


def file_with(suffix: str) -> Callable[[str], Path]:
    """Takes only names that end like the content they are for; raises ArgumentTypeError."""

    def path(text: str) -> Path:
        if Path(text).suffix.lower() != suffix:
            raise ArgumentTypeError(f"expected a file name that ends in {suffix}, found {text!r}")
        return Path(text)

    return path
