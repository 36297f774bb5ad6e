"""What an identification says: a table with its sentences for people, JSON ("crashkit-identification/1") for programs."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from attrs import asdict

from crashkit.protocols import Identification
from crashkit.report.document import plain
from crashkit.report.files import write_text
from crashkit.report.held import Held, told

COLUMNS = ("parameter", "value", "unit", "std", "95 % interval", "")
MANY = 0.05
"""Share of a channel from which readings that were left out are told first: recorders lose single ones, trackers a few in a
hundred; more are a channel, or a part of the motion, that the model does not explain."""
NOTHING = "-"
"""In the table, of what is not known."""


def write_identification(
    result: Identification, method: str, runs: Sequence[str], path: Path, held: Sequence[Held] = ()
) -> Path:
    """Write the result, and which numbers were held, as JSON, whole or not at all, and return its path."""
    document = {"schema": "crashkit-identification/1", "method": method, "runs": list(runs)} | as_plain(result)
    document["held"] = [asdict(one) for one in held]
    return write_text(path, json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def as_text(result: Identification, curves: xr.DataTree | None = None, held: Sequence[Held] = ()) -> str:
    """What a result says, for people: its status, a table of the parameters, what was held, what is not seen, remarks.

    Arguments:
        curves: predicted ones with their bands; of the runs that were not fitted, it is told how well they are met.
        held: numbers of the model that were not sought.
    """
    parameters = as_plain(result)["parameters"]
    blocks = ["\n".join([result.status.value, *_residuals(result)]), _table([_row(parameter) for parameter in parameters])]
    if held:
        blocks.append(told(held))
    if result.unseen:
        blocks.append("\n".join(["not known from these recordings:", *(f"  {sentence}" for sentence in result.unseen)]))
    if result.parameters.attrs["remarks"]:
        blocks.append(result.parameters.attrs["remarks"])
    predicted = [node for node in curves.leaves if not node.attrs["fitted"]] if curves else []
    if predicted:
        blocks.append("\n".join(["predicted, not fitted:", *map(_predicted, predicted)]))
    return "\n\n".join(blocks)


def as_plain(result: Identification) -> dict[str, Any]:
    """What a result says as plain JSON values; what is not finite becomes null."""
    table = result.parameters
    columns = {str(name): table[name].values.tolist() for name in table.data_vars if table[name].dims == ("parameter",)}
    names = {"parameter": table["parameter"].values.tolist(), **columns}
    document = {
        "status": result.status.name,
        "sentence": result.status.value,
        "cost": result.cost,
        "normalised_residual": table.attrs["normalised_residual"],
        "normalised_residual_of_all": _of_all(result),
        "left_out": table.attrs.get("left_out", {}),
        "parameters": [dict(zip(names, row, strict=True)) for row in zip(*names.values(), strict=True)],
        "covariance": table["covariance"].values.tolist(),
        "unseen": list(result.unseen),
        "remarks": table.attrs["remarks"],
    }
    if result.path is not None:
        document["path"] = {name: result.path[name].values.tolist() for name in ("cost", "value")}
    return {key: plain(value) for key, value in document.items()}


def _residuals(result: Identification) -> list[str]:
    """How large the residuals are, and of which channels they are only a part."""
    lines = [f"the residuals are {result.parameters.attrs['normalised_residual']:.3g} times the noise"]
    shares = result.parameters.attrs.get("left_out", {}).items()
    many = [f"{100.0 * share:.0f} % of {channel}" for channel, share in shares if share > MANY]
    if many:
        verb = "does not fit and was" if len(many) == 1 else "do not fit and were"
        left_out = f"{', '.join(many)} {verb} left out"
        lines.append(f"{left_out}; with all readings the residuals are {_of_all(result):.3g} times the noise")
    return lines


def _of_all(result: Identification) -> float:
    """The normalised residual of all readings, outliers and all."""
    attributes = result.parameters.attrs
    return float(attributes.get("normalised_residual_of_all", attributes["normalised_residual"]))


def _row(parameter: Mapping[str, Any]) -> tuple[str, ...]:
    """The cells of one parameter, its numbers to as many digits as they deserve."""
    value, std = parameter["value"], parameter["std"]
    note = "" if parameter["identifiable"] else "not identifiable"
    if parameter["at_bound"]:
        note = "at its lower bound" if value == parameter["lower"] else "at its upper bound"
    numbers = _number(value, 6), parameter["units"] or NOTHING, _number(std, 2), _interval(parameter)
    return parameter["parameter"], *numbers, note


def _predicted(node: xr.DataTree) -> str:
    """How far the readings of an instrument are from what was predicted, and how far the band is."""
    residual = float(np.sqrt((((node["recorded"] - node["predicted"]) / node["noise"]) ** 2).mean()))
    half = float(np.sqrt((((node["upper"] - node["lower"]) / 2.0) ** 2).mean()))
    missed = f"residuals {residual:.3g} times the noise, the parameters leave ±{half:.2g} {node.attrs['units']} open"
    return f"  {node.path.lstrip('/')}: {missed}"


def _interval(parameter: Mapping[str, Any]) -> str:
    """The interval; an end that only a bound sets is none."""
    low, high = parameter["interval_lower"], parameter["interval_upper"]
    is_low = low is not None and (parameter["lower"] is None or low > parameter["lower"])
    is_high = high is not None and (parameter["upper"] is None or high < parameter["upper"])
    if is_low and is_high:
        return f"{_number(low, 5)} to {_number(high, 5)}"
    if not is_low and not is_high:
        return NOTHING
    return f"at least {_number(low, 5)}" if is_low else f"at most {_number(high, 5)}"


def _number(value: float | None, digits: int) -> str:
    """So many significant digits, all numbers in one format whatever their digits: 230736, 230000."""
    return NOTHING if value is None else f"{float(f'{value:.{digits}g}'):.6g}"


def _table(rows: Sequence[tuple[str, ...]]) -> str:
    cells = [COLUMNS, *rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in cells)
    return "\n".join(line.rstrip() for line in lines)
