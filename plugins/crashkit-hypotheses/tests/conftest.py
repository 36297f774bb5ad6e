"""One engine for every hypothesis, so that the contracts share its compilation."""

import pytest

from crashkit.api import workshop
from crashkit.mechanics import Engine
from crashkit.testing import hypothesis_contract, toys


@pytest.fixture(scope="session")
def engine() -> Engine:
    return workshop().rehearsed(toys.two_degrees(), []).engine


@pytest.fixture(autouse=True)
def _one_engine(engine, monkeypatch) -> None:
    monkeypatch.setattr(hypothesis_contract, "_engine", lambda models: engine)
