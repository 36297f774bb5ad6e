"""Fit a model, or a claim about what it leaves out, and weigh what that explains."""
