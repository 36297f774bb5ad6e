"""What the studies of the mechanics share: models, the reference in C, the peers, and how time is taken."""
