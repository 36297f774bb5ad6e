"""What all tests of the core share: recordings and cases that lie beside the checkout."""

import os
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).parent.parent


def _beside(variable: str, name: str) -> Path:
    folder = Path(os.environ.get(variable, CHECKOUT.parent / "shared" / name))
    if not folder.is_dir():
        missing = pytest.fail if os.environ.get("CI") == "true" else pytest.skip
        missing(f"no {name} at {folder}: set {variable} to the folder that holds them")
    return folder


@pytest.fixture(scope="session")
def recordings() -> Path:
    """The folder of recordings of real crashes."""
    return _beside("CRASHKIT_RECORDINGS", "recordings")


@pytest.fixture(scope="session")
def cases() -> Path:
    """The folder of cases with something concealed in them."""
    return _beside("CRASHKIT_CASES", "cases")
