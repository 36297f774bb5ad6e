"""Arrays that are computed when somebody looks at them."""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from xarray.backends import BackendArray
from xarray.core import indexing


class Lazy(BackendArray):
    """An array of known shape for `xarray.core.indexing.LazilyIndexedArray`, as xarray reads its files.

    Arguments:
        shape: of the array.
        compute: gives its values, once.
    """

    def __init__(self, shape: tuple[int, ...], compute: Callable[[], np.ndarray]) -> None:
        self.shape = shape
        self.dtype = np.dtype(float)
        self._compute = compute

    def __getitem__(self, key: indexing.ExplicitIndexer) -> np.ndarray:
        support = indexing.IndexingSupport.BASIC
        return np.asarray(indexing.explicit_indexing_adapter(key, self.shape, support, self._values.__getitem__))

    @cached_property
    def _values(self) -> np.ndarray:
        return self._compute()
