"""The model: bodies, joints and the errors of the instruments that watch them."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TypeVar

from attrs import evolve, field, frozen

from crashkit.errors import CrashkitError
from crashkit.model.body import Body
from crashkit.model.choice import choice_fault
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.parameter import KnownSum, Parameter
from crashkit.model.summary import head_of, lines_of
from crashkit.model.value_checks import check_paths, check_values

Part = TypeVar("Part", Body, Joint)


@frozen(repr=False)
class Model:
    """A structure as rigid bodies joined by springs (Mizzi & Jezequel 1992, eq 2-11).

    Every number that could be identified has a path: `body.NAME.mass`, `body.NAME.inertia` (in space `body.NAME.inertia[i]`),
    `joint.NAME.PARAMETER`, `joint.NAME.PARAMETER[i]`, `joint.NAME.free_length`, `instrument.GROUP.SENSOR.PARAMETER` (SENSOR
    empty for the whole instrument).

    Arguments:
        name: for people.
        axes: one, two (plane motion) or three (space) of x, y, z, in this order.
        bodies, joints, instruments: the parts.
        gravity: m s-2, one value for each axis; (): none.
        sums: of numbers, that are known; of hypotheses only: no file holds them.
    """

    name: str
    axes: tuple[str, ...]
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    instruments: tuple[InstrumentErrors, ...] = field(default=())
    gravity: tuple[float, ...] = field(default=())
    sums: tuple[KnownSum, ...] = field(default=())

    def __repr__(self) -> str:
        head = head_of(self.name, self.axes, self.bodies, self.joints)
        return "\n".join([head, *lines_of(self.bodies, self.joints)])

    def body(self, name: str) -> Body:
        """The body of that name; raises CrashkitError for one it does not have."""
        return self._named("bodies", self.bodies, name)

    def joint(self, name: str) -> Joint:
        """The joint of that name; raises CrashkitError for one it does not have."""
        return self._named("joints", self.joints, name)

    def parameters(self) -> dict[str, Parameter]:
        """Every parameter by its path, in the order of the file."""
        return dict(self._known)

    def values(self) -> dict[str, float]:
        """The value of every parameter, SI units, by path."""
        return {path: parameter.value for path, parameter in self._known.items()}

    def free_parameters(self) -> dict[str, Parameter]:
        """The parameters that an identification may move, by path."""
        return {path: parameter for path, parameter in self._known.items() if not parameter.fixed}

    def with_parameters(self, changes: Mapping[str, Parameter]) -> "Model":
        """The same model with these parameters replaced, by path; raises CrashkitError for a path it does not have."""
        check_paths(changes, self.parameters(), f"model {self.name}")
        return self._replaced(changes)

    def with_values(self, values: Mapping[str, float]) -> "Model":
        """The same model with these values, bounds and freedom unchanged.

        Arguments:
            values: SI units, by path.

        Raises:
            CrashkitError: a path the model does not have, or a value that its file could not hold: one that is not finite, out
                of its bounds, or a mass that is not above 0.
        """
        check_values(values, self.parameters(), f"model {self.name}")
        return self.at(values)

    def at(self, values: Mapping[str, float]) -> "Model":
        """The same at any values, in bounds or not: for searches. Raises CrashkitError for a path the model does not have."""
        known = self.parameters()
        check_paths(values, known, f"model {self.name}")
        return self._replaced({path: evolve(known[path], value=float(value)) for path, value in values.items()})

    def _named(self, noun: str, parts: Sequence[Part], name: str) -> Part:
        known = {part.name: part for part in parts}
        if name not in known:
            raise CrashkitError(str(choice_fault(f"model {self.name}", noun, name, known)))
        return known[name]

    def _replaced(self, changes: Mapping[str, Parameter]) -> "Model":
        return evolve(
            self,
            bodies=tuple(_replace_body(body, changes) for body in self.bodies),
            joints=tuple(_replace_joint(joint, changes) for joint in self.joints),
            instruments=tuple(_replace_instrument(errors, changes) for errors in self.instruments),
        )

    @cached_property
    def _known(self) -> dict[str, Parameter]:
        """Every parameter by its path: searches ask again and again."""
        return dict(self._walk())

    def _walk(self) -> Iterator[tuple[str, Parameter]]:
        for body in self.bodies:
            if body.mass is not None:
                yield f"body.{body.name}.mass", body.mass
            yield from _inertia(body)
        for joint in self.joints:
            if joint.free_length is not None:
                yield f"joint.{joint.name}.free_length", joint.free_length
            for name, value in joint.parameters.items():
                yield from _entries(f"joint.{joint.name}.{name}", value)
        for errors in self.instruments:
            for name, parameter in errors.parameters.items():
                yield f"instrument.{errors.instrument}.{errors.sensor}.{name}", parameter


def _inertia(body: Body) -> Iterator[tuple[str, Parameter]]:
    path = f"body.{body.name}.inertia"
    return _entries(path, body.inertia[0] if len(body.inertia) == 1 else body.inertia)


def _entries(path: str, value: Parameter | tuple[Parameter, ...]) -> Iterator[tuple[str, Parameter]]:
    if isinstance(value, Parameter):
        yield path, value
    else:
        yield from ((f"{path}[{index}]", entry) for index, entry in enumerate(value))


def _replace_body(body: Body, changes: Mapping[str, Parameter]) -> Body:
    known = dict(_inertia(body))
    inertia = tuple(changes.get(path, parameter) for path, parameter in known.items())
    return evolve(body, mass=changes.get(f"body.{body.name}.mass", body.mass), inertia=inertia)


def _replace_joint(joint: Joint, changes: Mapping[str, Parameter]) -> Joint:
    prefix = f"joint.{joint.name}."
    return evolve(
        joint,
        free_length=changes.get(f"{prefix}free_length", joint.free_length),
        parameters={name: _replace(f"{prefix}{name}", value, changes) for name, value in joint.parameters.items()},
    )


def _replace(
    path: str, value: Parameter | tuple[Parameter, ...], changes: Mapping[str, Parameter]
) -> Parameter | tuple[Parameter, ...]:
    if isinstance(value, Parameter):
        return changes.get(path, value)
    return tuple(changes.get(f"{path}[{index}]", entry) for index, entry in enumerate(value))


def _replace_instrument(errors: InstrumentErrors, changes: Mapping[str, Parameter]) -> InstrumentErrors:
    prefix = f"instrument.{errors.instrument}.{errors.sensor}."
    return evolve(
        errors,
        parameters={name: changes.get(f"{prefix}{name}", entry) for name, entry in errors.parameters.items()},
    )
