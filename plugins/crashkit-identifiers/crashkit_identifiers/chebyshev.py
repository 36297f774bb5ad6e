"""Non-parametric identification: the force as a surface over deformation and rate, then the law that lies closest to it."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve, field, frozen

from crashkit.errors import CrashkitError
from crashkit.mechanics.joint_track import shared
from crashkit.mechanics.state_form import StateForm
from crashkit.misfit import Misfit, SameVariables
from crashkit.protocols import Identification, Identifier, Problem
from crashkit_identifiers.force_surface import Surface, fitted, interpolated, readings_of
from crashkit_identifiers.levenberg_marquardt import BySearch, Limits, advance, begin
from crashkit_identifiers.measured import known, measured_motions, require_seen
from crashkit_identifiers.recorded import engine_of, laws_of, require_plain_line, with_recordings
from crashkit_identifiers.result import conclude

FORMS = ("direct", "scattered")


@frozen(eq=False)
class SurfaceState(BySearch):
    """The search for the laws closest to the surfaces, the surface of each joint's force, and the measured motion."""

    surfaces: Mapping[str, Surface]
    measured: Mapping[str, xr.Dataset]


@frozen
class Chebyshev(Identifier[SurfaceState]):
    """x'' = -h(x, x'), with h a double Chebyshev series (Mizzi & Jezequel 1992, eq 34-37), of each joint.

    The answer to the question it asks is the surface: `start(problem).surfaces[joint].table()`. The parameters are those of
    the law closest to it where the recordings went; masses stay as they are. One axis; every body that a joint holds must be
    seen by an instrument; a surface needs runs at several speeds.

    Arguments:
        form: "direct" (least squares of the equations of motion) or "scattered" (the paper's interpolation of readings).
        degree: of the polynomials in each direction.
        points: in each direction, at which the scattered form interpolates.
        measurements: of each run that the scattered form uses.
        step_limit: of the fit of the laws.
    """

    name: ClassVar[str] = "chebyshev"
    form: str = field(default="direct")
    degree: int = 12
    points: int = 15
    measurements: int = 20
    step_limit: int = 60

    @form.validator
    def _check_form(self, attribute: object, value: str) -> None:
        if value not in FORMS:
            raise CrashkitError(f"{self.name}: expected a form of {', '.join(FORMS)}, found {value}")

    def start(self, problem: Problem) -> SurfaceState:
        """The surfaces, and the laws at the problem's own start."""
        misfit = with_recordings(problem, self.name)
        require_plain_line(misfit, self.name)
        measured = measured_motions(misfit)
        require_seen(misfit, measured, self.name)
        if self.form == "direct":
            surfaces = fitted(readings_of(misfit, measured), self.degree)
        else:
            surfaces = interpolated(readings_of(misfit, measured, self.measurements), self.degree, self.points)
        return SurfaceState(begin(_LawFit(misfit, measured, surfaces)), surfaces, measured)

    def step(self, problem: Problem, state: SurfaceState) -> SurfaceState:
        """One step of the laws towards the surfaces."""
        inner = _LawFit(with_recordings(problem, self.name), state.measured, state.surfaces)
        return evolve(state, search=advance(inner, state.search, Limits(tolerance=1e-8, steps=self.step_limit)))

    def finish(self, problem: Problem, state: SurfaceState) -> Identification:
        """The parameters, with what the recordings themselves say of them."""
        return conclude(problem, state.point, state.status, state.path)


class _LawFit(SameVariables):
    """What the laws leave of the surfaces along the measured motion, as a share of each surface's size."""

    def __init__(self, misfit: Misfit, measured: Mapping[str, xr.Dataset], surfaces: Mapping[str, Surface]) -> None:
        super().__init__(misfit)
        self.misfit = misfit
        forms = [StateForm(misfit.model, laws_of(misfit), known(motion), engine_of(misfit)) for motion in measured.values()]
        self._tracks = [track for form in forms for track in form.tracks]
        own = misfit.model.values()
        places = [(surfaces[track.law.joint.name], track.states(own)[:, :2].T) for track in self._tracks]
        self._wanted = [surface.force(*state) for surface, state in places]
        self._weights = [surface.is_inside(*state) / surface.size for surface, state in places]

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shares, and their derivatives to the search variables."""
        values = self.misfit.model.values() | self.misfit.values(scaled)
        residuals, slopes = [], []
        for track, wanted, weight in zip(self._tracks, self._wanted, self._weights, strict=True):
            force, table = track.push(track.modes(values), values)
            residuals.append((force - wanted) * weight)
            slopes.append(np.zeros((len(force), len(self.names))))
            own, columns = shared(track.paths, self.names)
            slopes[-1][:, columns] = table[:, own] * weight[:, None]
        return np.concatenate(residuals), np.concatenate(slopes) * self.scaling(scaled)
