"""The compiled part of the mechanics: an engine's module is a header and each module's text below its mark, in the order that
`engine.py` gives."""
