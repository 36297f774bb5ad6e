"""Name the physics: look after look, from near to far, each finding in the light of the others."""
