"""The quintic smoothing spline whose stiffness follows the motion: for pulses, the most accurate."""

from typing import ClassVar

import xarray as xr
from attrs import frozen

from crashkit.protocols import Smoother
from crashkit_smoothers.choice import ROBUST_CROSS_VALIDATION
from crashkit_smoothers.spline_smoother import SplineMethod


@frozen
class AdaptiveQuintic(Smoother):
    """Minimises sum (z_i - f(t_i))^2 + p integral w (f''')^2 dt over quintic splines f, with p by robust cross-validation.

    A first spline with w = 1 shows how rough the motion is where; w(t) is one over that. For the uncertainty, given noise,
    filtered channels and contacts see `GcvQuintic`.

    Arguments:
        contacts: s, instants at which the acceleration may jump, as where a contact begins or ends.
        find_contacts: look for such instants; the attribute `contacts` of the result names them.

    Mizzi & Jezequel 1992, eq 31; Lukas 2006, doi:10.1088/0266-5611/22/5/021; Pintore, Speckman & Holmes 2006,
    doi:10.1093/biomet/93.1.113.
    """

    name: ClassVar[str] = "adaptive_quintic"
    degree: ClassVar[int] = 2
    contacts: tuple[float, ...] = ()
    find_contacts: bool = False

    def smooth(self, samples: xr.DataArray, std: float | xr.DataArray | None = None) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says; `smoothing_parameter` is p, in s^5."""
        method = SplineMethod(self.name, 3, ROBUST_CROSS_VALIDATION, local=True)
        return method.smooth(samples, std, self.contacts, self.find_contacts)
