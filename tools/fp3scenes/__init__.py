"""Whole scenes in the laboratory, for tools/scenes.py: error against run time, stability, tuning, skipping. A module is a part."""
