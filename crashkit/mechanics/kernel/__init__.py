"""The compiled part of the mechanics: each module's text below its mark is pasted, in this order, behind the laws of an
engine."""
