"""Many simulations or fits, over any executor of `concurrent.futures`; what is on disk is not computed again."""

from crashkit.campaign.campaign import run
from crashkit.campaign.ensemble import ensemble

__all__ = ["ensemble", "run"]
