"""Attempts to break the package, each with a rule that it must keep: ``python -m campaign``."""
