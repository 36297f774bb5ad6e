"""The EV5 file of the NHTSA Vehicle Crash Test Database: what was tested and what each curve is."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from attrs import frozen

from crashkit.errors import ContractError, CrashkitError, Fault

CLOSING_SPEED, TITLE = 14, 1  # fields of the section TEST
CURVE_FIELDS = 20


@frozen
class Curve:
    """One line of the section INSTRUMENTATION.

    Arguments:
        number: of the curve, as in its file's name.
        vehicle: 1, 2, ... or 0 for the barrier.
        sensor_type: "AC" accelerometer, "LC" load cell, "DS" displacement, ...
        location: where the sensor sits, for example "FLLR".
        axis: direction and frame, for example "XG".
        unit: as the database spells it, "G'S", "NWT", "MM", ...
        comment: the laboratory's, for example "TOP OF ENGINE X".
    """

    number: int
    vehicle: int
    sensor_type: str
    location: str
    axis: str
    unit: str
    comment: str

    @property
    def kind(self) -> tuple[str, str, str]:
        """Sensor type, axis and unit: what curves must share to be joined."""
        return self.sensor_type, self.axis, self.unit

    @property
    def failed(self) -> bool:
        """Whether the laboratory says that the whole curve is void."""
        return self.comment.lower().endswith(("no valid data", "not installed"))


@frozen
class Ev5:
    """A test: its title, the closing speed (m s-1) and its curves by number."""

    title: str
    closing_speed: float
    curves: Mapping[int, Curve]


def read_ev5(folder: Path) -> Ev5:
    """The metadata of the one EV5 file in `folder`; raises CrashkitError or ContractError."""
    if not folder.is_dir():
        raise CrashkitError(
            f"{folder}: expected a folder of NHTSA text files, found {'a file' if folder.exists() else 'nothing'}"
        )
    found = sorted(path for path in folder.iterdir() if path.suffix.lower() == ".ev5")
    if len(found) != 1:
        raise CrashkitError(f"{folder}: expected one EV5 file, found {', '.join(path.name for path in found) or 'none'}")
    return _parse(found[0].name, found[0].read_text(encoding="latin-1"))


def _parse(name: str, text: str) -> Ev5:
    sections = _sections(text)
    tests = sections.get("TEST", [])
    if not tests or len(tests[0][1]) <= CLOSING_SPEED:
        raise ContractError(name, [Fault("section TEST", f"a line of more than {CLOSING_SPEED} fields", "none")])
    faults: list[Fault] = []
    curves = [_curve(number, fields, faults) for number, fields in sections.get("INSTRUMENTATION", [])]
    speed = _number(tests[0][1][CLOSING_SPEED], f"line {tests[0][0]}", "the closing speed in km/h", faults)
    if faults or not curves:
        raise ContractError(name, faults or [Fault("section INSTRUMENTATION", "a line for each curve", "none")])
    return Ev5(tests[0][1][TITLE], speed / 3.6, {curve.number: curve for curve in curves})


def _sections(text: str) -> dict[str, list[tuple[int, list[str]]]]:
    """Fields of each line by section, with the line's number."""
    sections: dict[str, list[tuple[int, list[str]]]] = {}
    current: list[tuple[int, list[str]]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("-----"):
            current = sections.setdefault(line.strip("- \t"), [])
        elif line.strip() and not line.startswith("#"):
            current.append((number, [field.strip() for field in line.split("|")]))
    return sections


def _curve(line: int, fields: Sequence[str], faults: list[Fault]) -> Curve:
    if len(fields) < CURVE_FIELDS:
        faults.append(Fault(f"line {line}", f"{CURVE_FIELDS} fields of a curve", str(len(fields))))
        return Curve(0, 0, "", "", "", "", "")
    vehicle, number = (int(_number(text, f"line {line}", "a whole number", faults)) for text in fields[:2])
    return Curve(number, vehicle, fields[2], fields[4], fields[5], fields[7], fields[-1])


def _number(text: str, place: str, expected: str, faults: list[Fault]) -> float:
    try:
        return float(text)
    except ValueError:
        faults.append(Fault(place, expected, repr(text)))
        return 0.0
