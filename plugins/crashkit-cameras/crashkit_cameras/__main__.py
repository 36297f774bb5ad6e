"""Finds targets in images, and follows them: `python -m crashkit_cameras detect IMAGE`, `... follow IMAGE [IMAGE ...]`."""

import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from crashkit.data.files import atomic_write
from crashkit.errors import CrashkitError
from crashkit_cameras.tracking import ImageFiles, detect, follow, mark, write_overlay


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; errors that a user can mend are told in a line."""
    arguments = _parser().parse_args(argv)
    try:
        arguments.run(arguments)
    except CrashkitError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> ArgumentParser:
    parser = ArgumentParser("python -m crashkit_cameras", description="Finds targets in images and follows them.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    finds = commands.add_parser("detect", help="propose the targets of an image")
    finds.add_argument("image", metavar="IMAGE", type=Path)
    finds.set_defaults(run=_detect)
    follows = commands.add_parser("follow", help="follow targets through a film, one file for each frame")
    follows.add_argument("images", metavar="IMAGE", nargs="+", help="the frames in the order of time")
    follows.add_argument("--rate", type=float, required=True, help="frames per second of the test")
    follows.add_argument("--first", type=float, default=0.0, help="time of the first frame, s")
    follows.add_argument(
        "--target", metavar="NAME=U,V", type=_target, action="append", required=True, help="on the first image"
    )
    follows.add_argument("--radius", type=float, default=float("nan"), help="of the targets, pixel, right to a quarter")
    follows.add_argument("--output", metavar="FILE.nc", type=Path, required=True, help="file for the track (netCDF)")
    follows.set_defaults(run=_follow)
    for command in (finds, follows):
        command.add_argument("--kind", default="quadrant", help="quadrant (default) or dot")
        command.add_argument("--overlay", metavar="IMAGE", type=Path, help="image to write, with the targets drawn in it")
    return parser


def _detect(arguments: Namespace) -> None:
    (frame,) = ImageFiles([arguments.image], rate=1.0)
    found = detect(frame.image, arguments.kind)
    print(f"{found.sizes['marker']} targets")
    for name in found["marker"].values.tolist():
        one = found.sel(marker=name)
        u, v = one["image_position"].values
        print(f"{name}={u:.2f},{v:.2f}  radius {float(one['radius']):.1f}  quality {float(one['quality']):.3f}")
    if arguments.overlay:
        write_overlay(frame.image, found, arguments.overlay)


def _follow(arguments: Namespace) -> None:
    film = ImageFiles(arguments.images, rate=arguments.rate, first=arguments.first)
    track = follow(film, mark(dict(arguments.target), arguments.kind, arguments.radius))
    atomic_write(arguments.output, lambda path: track.to_netcdf(path, engine="netcdf4"))
    for name in track["marker"].values.tolist():
        print(_summary(name, track.sel(marker=name)))
    if arguments.overlay:
        write_overlay(film[len(film) - 1].image, track.isel(time=-1), arguments.overlay)


def _summary(name: str, track: xr.Dataset) -> str:
    lost = int((track["lost"] != "").sum())
    std = float((track["image_position_std"] ** 2).mean() ** 0.5)
    return f"{name}: seen on {track.sizes['time'] - lost} of {track.sizes['time']} images, to {std:.3f} pixel"


def _target(text: str) -> tuple[str, tuple[float, float]]:
    name, _, place = text.partition("=")
    try:
        u, v = (float(number) for number in place.split(","))
    except ValueError:
        raise ArgumentTypeError(f"expected NAME=U,V, found {text!r}") from None
    return name, (u, v)


if __name__ == "__main__":
    sys.exit(main())
