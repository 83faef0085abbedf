"""Mutants of C: small changes, and which test sees each."""
