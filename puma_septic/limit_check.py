"""The one tolerance of every verdict: what is at its limit does not violate it."""

from __future__ import annotations

from typing import Final

__all__ = ["AT_LIMIT"]

AT_LIMIT: Final = 1e-9
"""A demand that exceeds its limit by no more than this part of the limit is at the limit, and keeps it.

It is five times what the arithmetic of a profile made at its limits leaves (2e-10 at most for `double_s` through
20 points with random limits), and far below any datum. A position, whose margin is a distance, keeps its bound if it
is beyond it by no more than this in rad (or m), the slack that inverse kinematics allows.
"""
