"""What the tests of all methods share: searches for the parameters of toys."""

import numpy as np
import pytest

from crashkit.misfit import Misfit
from crashkit.registry import load
from crashkit.testing import toys


@pytest.fixture(scope="session")
def search():
    """Makes the search for a toy from a start, from recordings at some speeds, with noise if asked."""

    def make(truth, factor=0.8, speeds=(1.0,), noise=0.0, seed=0):
        registry, random = load(), np.random.default_rng(seed)
        start = toys.start_from(truth, factor) if np.isscalar(factor) else factor
        problem = toys.problem(truth, start, registry.spring_laws, registry.observers, speeds)
        if not noise:
            return problem
        noisy = {run: toys.noisy(tree, noise, random) for run, tree in problem.recordings.items()}
        return Misfit(start, noisy, registry.spring_laws, registry.observers)

    return make


@pytest.fixture(scope="session")
def errors():
    """Relative errors of what was found, by parameter."""

    def of(found, truth):
        return {path: found.values[path] / parameter.value - 1.0 for path, parameter in truth.free_parameters().items()}

    return of
