"""A demand held against a limit, and a check that could not be made."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, final

import numpy as np

from puma_septic.limit_check import AT_LIMIT

__all__ = ["Kind", "NotAssessed", "Outcome", "SizingCheck", "most_used_first"]

Kind = Literal["physics", "vendor procedure", "rule of thumb"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SizingCheck:
    """One demand of one joint's drive train held against one limit.

    Attributes
    ----------
    joint, quantity : str
    demand, limit : float
        Of the same unit; a demand is infinite where it has no bound.
    unit : str
    time : float
        Critical instant, s; NaN for what is a mean over the cycle.
    kind : {"physics", "vendor procedure", "rule of thumb"}
        What happens beyond the limit: it cannot be; its maker does not vouch for it; it is merely unusual.
    source : str
        Where the rule comes from; the limit itself is the data sheet's.
    """

    joint: str
    quantity: str
    demand: float
    limit: float
    unit: str
    time: float
    kind: Kind
    source: str

    @property
    def utilisation(self) -> float:
        """``demand / limit``; infinite against a limit of zero."""
        if np.isinf(self.demand) or self.limit == 0:
            return np.inf
        return self.demand / self.limit

    @property
    def margin(self) -> float:
        """``1 - demand / limit``, negative where violated."""
        return 1 - self.utilisation

    @property
    def is_violated(self) -> bool:
        """Whether the demand exceeds the limit by more than `limit_check.AT_LIMIT`."""
        return not self.margin >= -AT_LIMIT

    def __str__(self) -> str:
        size = "unbounded" if np.isinf(self.demand) else f"{self.demand:.4g} {self.unit}".rstrip()
        when = "" if np.isnan(self.time) else f" at t = {self.time:.4g} s"
        limit = f"{self.limit:.4g} {self.unit}".rstrip()
        return f"{self.joint} {self.quantity} {size}{when} is {100 * self.utilisation:.4g} % of {limit} ({self.kind})"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class NotAssessed:
    """A check that could not be made, and why."""

    joint: str
    quantity: str
    reason: str


Outcome = SizingCheck | NotAssessed


def most_used_first(checks: Iterable[SizingCheck]) -> tuple[SizingCheck, ...]:
    """In order of utilisation; of two that agree to nine digits the one that is made first, whatever rounding says."""
    return tuple(sorted(checks, key=lambda check: -float(f"{check.utilisation:.9g}")))
