"""Many simulations or fits, over any executor of `concurrent.futures`; what is on disk is not computed again.

For many plain simulations of one model in memory, `crashkit.mechanics.simulate_many` is faster.
"""

from crashkit.campaign.campaign import run
from crashkit.campaign.cores import one_thread, spread

__all__ = ["one_thread", "run", "spread"]
