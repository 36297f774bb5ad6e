"""The smoothing splines of Mizzi & Jezequel: cubic, quintic and heptic, with generalised cross-validation."""

from typing import ClassVar

import xarray as xr
from attrs import frozen

from crashkit.protocols import Smoother
from crashkit_smoothers.choice import CROSS_VALIDATION
from crashkit_smoothers.spline_smoother import SplineMethod


@frozen
class GcvCubic(Smoother):
    """Minimises sum (z_i - f(t_i))^2 + p integral (f'')^2 dt over cubic splines f, with p by generalised cross-validation.

    Its second derivative is a polygon that ends at 0: good for values and velocities, poor for accelerations. For the
    uncertainty, given noise and filtered channels see `GcvQuintic`.

    Mizzi & Jezequel 1992, eq 31-32, q = 2.
    """

    name: ClassVar[str] = "gcv_cubic"
    degree: ClassVar[int] = 1

    def smooth(self, samples: xr.DataArray, std: float | xr.DataArray | None = None) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says; `smoothing_parameter` is p, in s^3."""
        return SplineMethod(self.name, 2, CROSS_VALIDATION).smooth(samples, std)


@frozen
class GcvQuintic(Smoother):
    """Minimises sum (z_i - f(t_i))^2 + p integral (f''')^2 dt over quintic splines f, with p by generalised cross-validation.

    The bands are those of the Bayesian posterior, s^2 (B'B + p R)^-1, with B the basis, R its roughness and s the noise:
    s^2 = |(I - A) z|^2 / tr(I - A) with A the influence matrix, unless it is given. Given noise weighs the samples, and p
    then minimises the unbiased risk, unless the samples show that there is more noise. It is taken as white, or as white
    before the filter that the samples declare.

    Arguments:
        contacts: s, instants at which the acceleration may jump, as where a contact begins or ends; at the instant itself
            the result is the limit from later times.
        find_contacts: look for such instants; the attribute `contacts` of the result names them.

    Mizzi & Jezequel 1992, eq 31-32, q = 3; Wahba 1983, doi:10.1111/j.2517-6161.1983.tb01239.x.
    """

    name: ClassVar[str] = "gcv_quintic"
    degree: ClassVar[int] = 2
    contacts: tuple[float, ...] = ()
    find_contacts: bool = False

    def smooth(self, samples: xr.DataArray, std: float | xr.DataArray | None = None) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says; `smoothing_parameter` is p, in s^5."""
        return SplineMethod(self.name, 3, CROSS_VALIDATION).smooth(samples, std, self.contacts, self.find_contacts)


@frozen
class GcvHeptic(Smoother):
    """Minimises sum (z_i - f(t_i))^2 + p integral (f'''')^2 dt over heptic splines f, with p by generalised cross-validation.

    For motions without corners. For the uncertainty, given noise, filtered channels and contacts see `GcvQuintic`.

    Mizzi & Jezequel 1992, eq 31-32, with q = 4.
    """

    name: ClassVar[str] = "gcv_heptic"
    degree: ClassVar[int] = 3
    contacts: tuple[float, ...] = ()
    find_contacts: bool = False

    def smooth(self, samples: xr.DataArray, std: float | xr.DataArray | None = None) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says; `smoothing_parameter` is p, in s^7."""
        return SplineMethod(self.name, 4, CROSS_VALIDATION).smooth(samples, std, self.contacts, self.find_contacts)
