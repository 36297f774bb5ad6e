"""crashkit: models, observes and identifies crash structures, and finds the physics that a model left out."""
