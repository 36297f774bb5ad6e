"""A laboratory's own files as a recording."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import options


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("import", help=__doc__, description=__doc__)
    parser.add_argument("format", metavar="FORMAT", help="an installed importer, for example nhtsa")
    parser.add_argument("source", metavar="SOURCE", type=Path, help="folder or file")
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--list", action="store_true", help="show the channels that the source holds")
    action.add_argument("--output", metavar="FILE.nc", type=options.file_with(".nc"), help="file for the recording (netCDF)")
    parser.add_argument(
        "--channel",
        metavar="CHANNEL[+CHANNEL...]=BODY[:SENSOR]",
        action="append",
        default=[],
        help="a channel and the model's body that it sees; the format says how channels joined by + become one",
    )
    parser.add_argument(
        "--option", metavar="KEY=VALUE", type=options.pair, action="append", default=[], help="an option of the format"
    )
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Write the recording, or list the channels."""
    from crashkit import api
    from crashkit.data.files import check_outputs

    if arguments.list:
        print(api.list_channels(arguments.format, arguments.source))
    else:
        check_outputs([arguments.source], [arguments.output])
        told = dict(arguments.option)
        print(api.import_recording(arguments.format, arguments.source, arguments.output, arguments.channel, told))
