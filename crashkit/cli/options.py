"""Options of a plugin, written KEY=VALUE."""

from argparse import ArgumentTypeError


def pair(text: str) -> tuple[str, str]:
    """The key and the value; raises ArgumentTypeError where there is none."""
    key, equals, value = text.partition("=")
    if not (key and equals):
        raise ArgumentTypeError(f"expected KEY=VALUE, found {text!r}")
    return key, value
