"""Work on all cores gives what one core gives."""

import os
from time import sleep

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from threadpoolctl import threadpool_info, threadpool_limits

from crashkit.campaign import one_thread, spread


@settings(max_examples=10, deadline=None)
@given(st.lists(st.integers(-1000, 1000), max_size=20))
def test_the_results_come_in_the_order_of_the_items(items):
    assert spread(lambda n: n * n, items) == [n * n for n in items]


def test_arrays_come_back_whole():
    results = spread(lambda n: np.full(100_000, float(n)), range(6))
    assert [float(one.sum()) for one in results] == [1e5 * n for n in range(6)]


def test_a_task_may_spread_its_own_work():
    assert spread(lambda n: sum(spread(lambda m: n * m, range(4))), range(5)) == [6 * n for n in range(5)]


def test_an_error_in_a_task_is_seen_here():
    def fails(n):
        if n == 3:
            raise ValueError(f"item {n}")
        return n

    with pytest.raises(ValueError, match="item 3"):
        spread(fails, range(6))


def test_what_a_copy_leaves_undone_is_done_here():
    own = os.getpid()
    results = spread(lambda n: os.getpid() if os.getpid() == own else os._exit(1), range(6))
    assert results == [own] * 6


def test_progress_never_goes_back():
    told = []
    spread(lambda n: n, range(8), told.append)
    assert told == sorted(told)
    assert set(told) <= set(range(8))


def threads():
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def test_small_matrices_are_left_to_one_thread_and_then_all_is_as_before():
    with threadpool_limits(2, "blas"):
        assert (threads(), one_thread(threads)(), threads()) == ({2}, {1}, {2})


def test_where_telling_raises_nothing_more_is_taken(tmp_path):
    def told(done):
        if done > 3:
            raise TimeoutError("enough")

    def leave_a_trace(number):
        (tmp_path / str(number)).touch()
        sleep(0.02)

    with pytest.raises(TimeoutError, match="enough"):
        spread(leave_a_trace, range(200), told)
    sleep(1.0)
    assert len(list(tmp_path.iterdir())) < 40
