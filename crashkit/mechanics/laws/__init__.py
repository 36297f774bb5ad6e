"""From the source of a spring law to the functions that the engine calls: its branches, guards and derivatives."""
