"""Residuals in measurement space, the noise they are weighed against, and ratings of curves."""

from crashkit.misfit.channel import Channel, Group
from crashkit.misfit.fine_step import bears_step, fine_step
from crashkit.misfit.noise import Noise, channel_noise
from crashkit.misfit.problem import Misfit
from crashkit.misfit.wrapped import SameVariables

__all__ = ["Channel", "Group", "Misfit", "Noise", "SameVariables", "bears_step", "channel_noise", "fine_step"]
