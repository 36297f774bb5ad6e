"""Readers of laboratories' own formats."""
