"""Whether a diagnosis is right: verdict, physics, place, and nothing claimed that is not there."""

from collections.abc import Mapping, Sequence
from typing import Any

from attrs import asdict, frozen

Claim = tuple[str, str, Any]
"""Physics, kind of place, place; two bodies in either order are one place."""

_KINDS = ("joint", "bodies", "body", "sensor", "instrument")
_INSTRUMENTS = ("sensor", "instrument")


@frozen
class Score:
    """What was right in one answer.

    Arguments:
        verdict_right, physics_right, place_right: whether the verdict is; whether every secret's physics was named; and at
            its place.
        spurious: what was claimed that is not there, as "physics at place".
        listed: whether every secret was at least named among the rivals of a finding.
        claims: probability of each finding, and whether it is there.
    """

    verdict_right: bool
    physics_right: bool
    place_right: bool
    spurious: tuple[str, ...]
    listed: bool
    claims: tuple[tuple[float, bool], ...]

    @property
    def right(self) -> bool:
        """Everything is right."""
        return self.verdict_right and self.physics_right and self.place_right and not self.spurious

    def record(self) -> dict[str, Any]:
        """As JSON holds it."""
        return {"right": self.right, **asdict(self)}


def score(diagnosis: Mapping[str, Any], truth: Mapping[str, Any]) -> Score:
    """Compare a diagnosis.json with an answer.

    Arguments:
        diagnosis: as crashkit writes it.
        truth: `accept`: right answers [physics, kind of place, place]; `all`: whether each must be found, or one of them.
    """
    wanted = [_claim(*answer) for answer in truth["accept"] if answer[0] != "consistent"]
    findings = diagnosis["findings"]
    found = [_located(finding) for finding in findings]
    listed = found + [_located(rival) for finding in findings for rival in finding.get("alternatives", ())]
    together = bool(truth["all"])
    there = [claim for claim in found if claim in wanted]
    return Score(
        verdict_right=diagnosis["verdict"] in verdicts(wanted if together else there or wanted, together),
        physics_right=_met([claim[0] for claim in wanted], [claim[0] for claim in found], together),
        place_right=_met(wanted, found, together),
        spurious=tuple(words(claim) for claim in found if claim not in wanted),
        listed=_met(wanted, listed, together),
        claims=tuple((float(f["probability"]), c in wanted) for f, c in zip(findings, found, strict=True)),
    )


def verdicts(wanted: Sequence[Claim], together: bool) -> set[str]:
    """The right verdicts: of several secrets at once the structural ones decide, of rivals each has its own."""
    if not wanted:
        return {"consistent"}
    return {_verdict(wanted)} if together else {_verdict([claim]) for claim in wanted}


def words(claim: Claim) -> str:
    """A claim to be read."""
    physics, kind, place = claim
    return f"{physics} at {kind} {' and '.join(place) if isinstance(place, list) else place}"


def _verdict(claims: Sequence[Claim]) -> str:
    named = [kind for physics, kind, _ in claims if physics != "unknown"]
    if any(kind not in _INSTRUMENTS for kind in named):
        return "missing_physics"
    return "sensor_fault" if len(named) == len(claims) else "unexplained"


def _located(finding: Mapping[str, Any]) -> Claim:
    location = finding["location"]
    kind = next(kind for kind in _KINDS if kind in location)
    return _claim(finding["physics"], kind, location[kind])


def _claim(physics: str, kind: str, place: Any) -> Claim:
    return physics, kind, sorted(place) if isinstance(place, list) else place


def _met(wanted: Sequence[Any], found: Sequence[Any], together: bool) -> bool:
    if not wanted:
        return not found
    return all(one in found for one in wanted) if together else any(one in found for one in wanted)
