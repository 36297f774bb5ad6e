"""A model's free parameters from recordings."""

from __future__ import annotations

import json
import math
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crashkit.cli import progress
from crashkit.errors import CrashkitError

if TYPE_CHECKING:
    from crashkit.misfit import Misfit
    from crashkit.protocols import Identification, Identifier

COLUMNS = ("parameter", "value", "unit", "std", "95 % interval", "")
NOTHING = "-"
"""In the table, of what is not known."""


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("identify", help=__doc__, description=__doc__)
    parser.add_argument("model", metavar="MODEL", type=Path, help="model file (TOML)")
    parser.add_argument("runs", metavar="RUN", type=Path, nargs="+", help="recordings to fit (netCDF)")
    parser.add_argument("--method", metavar="NAME", default="multi_start", help="an installed identifier (%(default)s)")
    parser.add_argument("--output", metavar="MODEL.toml", type=Path, help="file for the identified model")
    parser.add_argument("--json", metavar="FILE", type=Path, help="file for all that the result says, with its path")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Identify, print what was found, write what is asked for."""
    from crashkit.model.toml import write_model
    from crashkit.registry import load

    registry = load()
    identifier = registry.identifier(arguments.method)()
    misfit = _misfit(arguments.model, arguments.runs)
    result = _identified(identifier, misfit)
    if arguments.output:
        write_model(misfit.model.with_values(result.values), arguments.output, registry.spring_laws)
    if arguments.json:
        document = {"schema": "crashkit-identification/1", "method": arguments.method, "runs": list(misfit.recordings)}
        text = json.dumps(document | as_plain(result), indent=1, ensure_ascii=False, allow_nan=False)
        arguments.json.write_text(text + "\n", encoding="utf-8")
    print(as_text(result))


def as_text(result: Identification) -> str:
    """What a result says, for people: its status, a table of the parameters, what is not seen, remarks."""
    parameters = as_plain(result)["parameters"]
    residuals = f"the residuals are {result.parameters.attrs['normalised_residual']:.3g} times the noise"
    blocks = [f"{result.status.value}\n{residuals}", _table([_row(parameter) for parameter in parameters])]
    if result.unseen:
        blocks.append("\n".join(["not known from these recordings:", *(f"  {sentence}" for sentence in result.unseen)]))
    if result.parameters.attrs["remarks"]:
        blocks.append(result.parameters.attrs["remarks"])
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
        "parameters": [dict(zip(names, row, strict=True)) for row in zip(*names.values(), strict=True)],
        "covariance": table["covariance"].values.tolist(),
        "unseen": list(result.unseen),
        "remarks": table.attrs["remarks"],
    }
    if result.path is not None:
        document["path"] = {name: result.path[name].values.tolist() for name in ("cost", "value")}
    return {key: _plain(value) for key, value in document.items()}


def _misfit(model_file: Path, run_files: Sequence[Path]) -> Misfit:
    from crashkit import api
    from crashkit.misfit import Misfit
    from crashkit.model.checks import check_recording_against_model
    from crashkit.registry import load

    model, recordings = api.load_model(model_file), api.load_recordings(run_files)
    for name, recording in recordings.items():
        check_recording_against_model(recording, model, name)
    if not model.free_parameters():
        raise CrashkitError(f"{model_file}: expected a free parameter, found that all are fixed")
    return Misfit(model, recordings, load().spring_laws, load().observers)


def _identified(identifier: Identifier[Any], misfit: Misfit) -> Identification:
    """From start to finish; raises CrashkitError where the model cannot be simulated at the start."""
    from crashkit.protocols import Status

    state = identifier.start(misfit)
    while state.status is Status.RUNNING:
        state = identifier.step(misfit, state)
        progress.show(f"cost {state.cost:.6g}")
    if state.status is Status.FAILED:
        raise CrashkitError(f"{identifier.name}: {Status.FAILED.value}")
    return identifier.finish(misfit, state)


def _row(parameter: Mapping[str, Any]) -> tuple[str, ...]:
    """The cells of one parameter, its numbers to as many digits as they deserve."""
    value, std = parameter["value"], parameter["std"]
    note = "" if parameter["identifiable"] else "not identifiable"
    if parameter["at_bound"]:
        note = "at its lower bound" if value == parameter["lower"] else "at its upper bound"
    return parameter["parameter"], f"{value:.6g}", parameter["units"] or NOTHING, _number(std, 2), _interval(parameter), note


def _interval(parameter: Mapping[str, Any]) -> str:
    """The interval; an end that only a bound sets is none."""
    low, high = parameter["interval_lower"], parameter["interval_upper"]
    is_low = low is not None and (parameter["lower"] is None or low > parameter["lower"])
    is_high = high is not None and (parameter["upper"] is None or high < parameter["upper"])
    if is_low and is_high:
        return f"{low:.5g} to {high:.5g}"
    if not is_low and not is_high:
        return NOTHING
    return f"at least {low:.5g}" if is_low else f"at most {high:.5g}"


def _number(value: float | None, digits: int) -> str:
    return NOTHING if value is None else f"{value:.{digits}g}"


def _table(rows: Sequence[tuple[str, ...]]) -> str:
    cells = [COLUMNS, *rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in cells)
    return "\n".join(line.rstrip() for line in lines)


def _plain(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    return value
