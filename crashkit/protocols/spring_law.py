"""SpringLaw: the force of a joint, or a factor that multiplies it, as one pure scalar function."""

from abc import ABC
from collections.abc import Callable, Mapping
from typing import ClassVar

from crashkit.protocols.parameter import ParameterSpec


def no_change(*state: float) -> float:
    """The rate of a memory that stays as it is."""
    return 0.0


class SpringLaw(ABC):
    """The force of a joint from deformation, rate, largest deformation and parameters.

    F = force(d, ddot, d_max, *parameters), with d positive in compression.

    `force` is plain scalar Python: assignments, `if` with comparisons, `min`, `max`, `abs`, arithmetic, functions of `math`,
    functions of your own that keep to the same, and `for` over vector parameters. The engine reads its source, derives
    branches, guards and partial derivatives from it, and compiles it. The engine owns the memory: it passes `d_max >= d`, the
    largest deformation reached so far (at least 0), and while the joint is being loaded further `d_max` is `d` itself.
    The value must be continuous in d, ddot and d_max, unless the law declares that it jumps.

    A law with a memory of its own (a force that relaxes, for example) names it in `memory`. The name is then the fourth
    argument of `force` and of `memory_rate`, which gives its rate of change: memory' = memory_rate(d, ddot, d_max, memory,
    *parameters). It is 0 at t = 0.

    A law that needs more Python than this runs as it is: slowly, and without sensitivities. To have both back, its author
    gives its branches himself, as functions that numba compiles and that take vectors as arrays:

        branch(d, ddot, d_max, *parameters) -> int: which branch a state takes;
        branch_force(branch, d, ddot, d_max, *parameters) -> (force, distance): the force on a branch, also a little beyond its
            end, and how far its end is, negative beyond it;
        branch_slopes(branch, d, ddot, d_max, *parameters, slopes): writes the derivatives of that force to d, ddot, d_max, the
            memory if there is one, and every number of the parameters into the array `slopes`, in this order.

    Attributes:
        name: as written in model files.
        unit: "N" for a law; "1" for a factor that multiplies a law (a joint lists them under `factors`).
        parameters: declared in the order in which `force` takes them.
        memory: name of the law's own memory; "" for none.
        jumps: the value, or the rate of the memory, may jump where a branch changes (fracture); the engine then gives the
            sensitivities their jump.
        passive: the law never gives out more energy than it took in (tested by the contract suite).
        driven: the value depends on d and ddot of another joint, the `driver` of its own, in one smooth piece: without
            branches, `min`, `max` and `abs`, and without a memory.
        opaque: the law is meant to run as plain Python.
        force: the pure scalar function, as a staticmethod.
        memory_rate: the rate of change of the memory, likewise, if there is one.
        branch, branch_force, branch_slopes: likewise, where the author gives the branches himself.
        parts: the laws and factors that a combined law is made of.
    """

    name: ClassVar[str]
    unit: ClassVar[str] = "N"
    parameters: ClassVar[tuple[ParameterSpec, ...]]
    memory: ClassVar[str] = ""
    jumps: ClassVar[bool] = False
    passive: ClassVar[bool] = True
    driven: ClassVar[bool] = False
    opaque: ClassVar[bool] = False
    force: ClassVar[Callable[..., float]]
    memory_rate: ClassVar[Callable[..., float]] = staticmethod(no_change)
    branch: ClassVar[Callable[..., int] | None] = None
    branch_force: ClassVar[Callable[..., tuple[float, float]] | None] = None
    branch_slopes: ClassVar[Callable[..., None] | None] = None
    parts: ClassVar[tuple[type["SpringLaw"], ...]] = ()


Laws = Mapping[str, type[SpringLaw]]
"""Installed laws and factors by name."""
