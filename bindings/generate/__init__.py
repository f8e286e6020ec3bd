"""Reads packcell.h (header.py) and writes each language's raw layer from what was read."""
