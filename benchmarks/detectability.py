"""The smallest effect that is found: each physics, in several vehicles, at sizes between which one is halved.

Vehicles have one body and all instruments, each secret its plainest form. A size is what the secret leaves in the recordings
once the model's own numbers are tuned to them, in standard deviations; found means that the whole answer is right. Prints
the table of docs/blind-trial.md, and draws its figure.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np
from attrs import frozen

from benchmarks import Row
from benchmarks.blind.score import score
from benchmarks.blind.trial import diagnosed, read_diagnosis
from crashkit.diagnose.name.rivals import SEEN
from crashkit.testing.concealed import EFFECTS, make_case, write_case
from crashkit.testing.concealed.sensor_effects import SENSOR_EFFECTS

SIZES = (4.0, 5.7, 8.0, 11.3, 16.0, 22.6, 32.0, 45.0, 64.0)
"""Standard deviations; a case may be a tenth off."""
LIMIT = 240.0
"""s that a diagnosis may take."""
FIGURE = Path(__file__).parent.parent / "docs" / "detectability" / "curve.png"


@frozen
class Threshold:
    """Between which sizes a physics begins to be found in a vehicle.

    Attributes:
        physics: that is concealed.
        missed: the largest size at which it was not found; 0: it always was.
        found: the smallest at which it was; infinite: it never was.
    """

    physics: str
    missed: float
    found: float


def add_arguments(parser: ArgumentParser) -> None:
    """How many vehicles, and which."""
    parser.add_argument("--vehicles", metavar="N", type=int, default=3, help="for each physics (%(default)s)")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of everything random (%(default)s)")
    parser.add_argument("--only", metavar="PHYSICS", nargs="+", choices=EFFECTS, default=tuple(EFFECTS), help="(all)")
    parser.add_argument("--workers", metavar="W", type=int, default=1, help="(%(default)s)")


def run(options: Namespace) -> list[Row]:
    """For each physics the median of the smallest sizes that are found, beside the theoretical bound."""
    tasks = [(physics, (options.seed, number)) for physics in options.only for number in range(options.vehicles)]
    with ProcessPoolExecutor(options.workers, mp_context=get_context("spawn")) as executor:
        thresholds = [one for one in executor.map(threshold, *zip(*tasks, strict=True)) if one is not None]
    print(table(thresholds), end="\n\n")
    FIGURE.parent.mkdir(exist_ok=True)
    draw(thresholds, FIGURE)
    groups = {physics: [one for one in thresholds if one.physics == physics] for physics in options.only}
    told = "found from, standard deviations, median"
    return [
        Row(f"{physics}: {told} of {len(group)}", "error", "1", median(one.found for one in group), "bound", SEEN)
        for physics, group in groups.items()
        if group
    ]


def threshold(physics: str, seed: tuple[int, ...]) -> Threshold | None:
    """Halve the sizes between the largest that is missed and the smallest that is found; None: no vehicle shows it."""
    low, high = -1, len(SIZES)
    while high - low > 1:
        middle = (low + high) // 2
        found = is_found(physics, SIZES[middle], seed)
        if found is None:
            return None
        low, high = (low, middle) if found else (middle, high)
    result = Threshold(physics, SIZES[low] if low >= 0 else 0.0, SIZES[high] if high < len(SIZES) else np.inf)
    print(f"{physics} {seed}: missed at {result.missed:g}, found from {result.found:g}", flush=True)
    return result


def is_found(physics: str, size: float, seed: tuple[int, ...]) -> bool | None:
    """Whether a diagnosis is right about it; None where no vehicle shows so much of it."""
    try:
        case = make_case(seed, (physics,), (0.9 * size, 1.1 * size), plain=True)
    except ValueError:
        return None
    with TemporaryDirectory() as folder:
        write_case(case, Path(folder) / "case")
        output = Path(folder) / "diagnosis"
        if diagnosed(Path(folder) / "case", output, LIMIT)["status"] != "done":
            return False
        return score(read_diagnosis(output), case.answer).right


def share_found(thresholds: Sequence[Threshold], size: float) -> float:
    """Of all vehicles: in how many an effect of a size is found."""
    return float(np.mean([one.found <= size for one in thresholds]))


def table(thresholds: Sequence[Threshold]) -> str:
    """For each physics, from which size it was found in each vehicle."""
    lines = ["| physics | found from, standard deviations, in each vehicle |", "| --- | --- |"]
    for physics in dict.fromkeys(one.physics for one in thresholds):
        sizes = sorted(one.found for one in thresholds if one.physics == physics)
        told = ", ".join(f"{size:g}" if np.isfinite(size) else f"more than {SIZES[-1]:g}" for size in sizes)
        lines.append(f"| {physics} | {told} |")
    return "\n".join(lines)


def draw(thresholds: Sequence[Threshold], path: Path) -> None:
    """The share that is found against the size, of structures and of sensors."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6.5, 3.6), layout="constrained")
    for title, of_sensors in (("joints and bodies", False), ("sensors", True)):
        own = [one for one in thresholds if (one.physics in SENSOR_EFFECTS) == of_sensors]
        if own:
            axes.plot(SIZES, [100.0 * share_found(own, size) for size in SIZES], "o-", label=f"{title} ({len(own)} vehicles)")
    axes.axvline(SEEN, color="grey", ls="--", label="bound")
    axes.axhline(90.0, color="grey", lw=0.5)
    axes.set(xscale="log", xlabel="standard deviations left after re-identification", ylabel="found, %", ylim=(0.0, 103.0))
    axes.set_xticks(SIZES, [f"{size:g}" for size in SIZES])
    axes.minorticks_off()
    axes.legend()
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
