"""Which cases a trial consists of: chance decides, in fixed shares."""

from collections.abc import Sequence

import numpy as np
from attrs import frozen

from crashkit.testing.concealed import EFFECTS, SIZES

SHARES = {"null": 0.15, "pair": 0.15}
"""Of the cases; the others conceal one physics each, all equally often."""


@frozen
class Ticket:
    """One case to be made: its name, its seed, what it conceals and in which size. The name does not tell."""

    name: str
    seed: tuple[int, ...]
    physics: tuple[str, ...]
    size: str


def plan(cases: int, seed: int, only: Sequence[str] = (), sizes: Sequence[str] = tuple(SIZES)) -> list[Ticket]:
    """The tickets of a trial; the first ones are the same, however many there are.

    Arguments:
        cases: how many.
        seed: of the trial.
        only: of "null", "pair" and the names in EFFECTS; none: all in their shares.
        sizes: to choose from.
    """
    return [_ticket(number, seed, only, sizes) for number in range(1, cases + 1)]


def _ticket(number: int, seed: int, only: Sequence[str], sizes: Sequence[str]) -> Ticket:
    rng = np.random.default_rng([seed, number])
    size = str(rng.choice(sizes))
    kind = _in_turn(number, seed, only or list(EFFECTS))
    if not only:
        kind = str(rng.choice([*SHARES, kind], p=[*SHARES.values(), 1.0 - sum(SHARES.values())]))
    physics: tuple[str, ...] = () if kind == "null" else (kind,)
    if kind == "pair":
        physics = tuple(str(name) for name in rng.permutation([name for name in EFFECTS if name != "unknown"])[:2])
    return Ticket(f"case_{number:04d}", (seed, number), physics, size)


def _in_turn(number: int, seed: int, names: Sequence[str]) -> str:
    """Each name comes once in as many cases as there are names, in an order that changes."""
    turn, place = divmod(number - 1, len(names))
    return str(np.random.default_rng([seed, 0, turn]).permutation(names)[place])
