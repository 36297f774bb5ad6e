"""A model's free parameters from recordings."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import options, progress


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("identify", help=__doc__, description=__doc__)
    parser.add_argument("model", metavar="MODEL", type=Path, help="model file (TOML)")
    parser.add_argument("runs", metavar="RUN", type=Path, nargs="+", help="recordings to fit (netCDF)")
    parser.add_argument("--method", metavar="NAME", default="multi_start", help="an installed identifier (%(default)s)")
    parser.add_argument("--predict", metavar="RUN", type=Path, nargs="+", default=[], help="recordings to predict, not to fit")
    toml, netcdf = options.file_with(".toml"), options.file_with(".nc")
    parser.add_argument("--output", metavar="MODEL.toml", type=toml, help="file for the identified model")
    parser.add_argument("--json", metavar="FILE", type=Path, help="file for all that the result says, with its path")
    parser.add_argument(
        "--curves", metavar="FILE.nc", type=netcdf, help="file for the predicted curves with their 95 %% bands"
    )
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Identify, print what was found, write what is asked for."""
    from crashkit import api
    from crashkit.data.files import check_outputs

    outputs = [arguments.output, arguments.json, arguments.curves]
    check_outputs([arguments.model, *arguments.runs, *arguments.predict], outputs)
    told = api.identify_files(
        arguments.model,
        arguments.runs,
        arguments.method,
        progress.show,
        predicted=arguments.predict,
        output=arguments.output,
        document=arguments.json,
        curves=arguments.curves,
    )
    print(told)
    progress.tell_written(outputs)
