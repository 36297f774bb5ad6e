"""Campaigns: in order, resumable, whole files."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr

from crashkit.campaign import run
from crashkit.errors import CrashkitError

ITEMS = {"nine": 9.0, "four": 4.0, "one": 1.0}


def root(value: float) -> xr.Dataset:
    return xr.Dataset({"root": ("sample", [np.sqrt(value), -np.sqrt(value)], {"units": "m"})}, attrs={"of": value})


@pytest.fixture(params=["this thread", "two threads"])
def executor(request):
    if request.param == "this thread":
        yield None
    else:
        with ThreadPoolExecutor(2) as pool:
            yield pool


def test_results_come_in_the_order_of_the_items(tmp_path, executor):
    results = run(root, ITEMS, tmp_path / "new", executor)
    assert list(results) == list(ITEMS)
    for name, value in ITEMS.items():
        assert results[name].identical(root(value))
    assert {file.name for file in (tmp_path / "new").iterdir()} == {"nine.nc", "four.nc", "one.nc"}


def test_what_is_on_disk_is_not_computed_again(tmp_path, executor):
    asked = []

    def watched(value):
        asked.append(value)
        return root(value)

    first = run(watched, {"four": 4.0}, tmp_path, executor)
    again = run(watched, ITEMS, tmp_path, executor)
    assert sorted(asked) == [1.0, 4.0, 9.0]
    assert again["four"].identical(first["four"])


def test_a_campaign_that_fails_keeps_what_it_had_and_goes_on_from_there(tmp_path, executor):
    run(root, {"nine": 9.0}, tmp_path, executor)

    def failing(value):
        raise ZeroDivisionError(f"no root of {value}")

    with pytest.raises(ZeroDivisionError, match="no root of"):
        run(failing, ITEMS, tmp_path, executor)
    assert [file.name for file in tmp_path.iterdir()] == ["nine.nc"]
    assert len(run(root, ITEMS, tmp_path, executor)) == 3


def test_a_result_is_written_before_the_next_is_computed(tmp_path):
    def second_sees_first(value):
        assert value == 9.0 or (tmp_path / "nine.nc").exists()
        return root(value)

    run(second_sees_first, ITEMS, tmp_path)


@pytest.mark.parametrize("name", ["", "a/b", "..", "../above", ".hidden"])
def test_a_name_that_is_no_file_name_is_refused_before_anything_is_computed(tmp_path, name):
    with pytest.raises(CrashkitError, match="^expected names of items that can be file names, found "):
        run(root, {"fine": 1.0, name: 4.0}, tmp_path)
    assert not any(tmp_path.iterdir())
