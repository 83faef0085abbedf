"""Mutants of the hardware: tools/mutate.py."""
