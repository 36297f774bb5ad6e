"""The smallest possible crashkit plugin: one spring law."""
