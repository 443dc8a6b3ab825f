"""The version of the package: once, for the interpreter, the build and the reports."""

from __future__ import annotations

__all__ = ["__version__"]

__version__ = "0.1.0"
