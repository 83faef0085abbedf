"""Rigid bodies beside theory and beside other engines: tools/bodies.py."""
