"""The marker of the cases."""

import pytest


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "cases: concealed physics to be found, a minute each; `-m cases` runs all of them")
