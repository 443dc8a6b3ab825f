"""A demand checked against a limit, and the one tolerance of every verdict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from math import inf, isfinite, isinf, isnan
from typing import Any, Final, Literal, Self, final

from puma_septic.document import numeric, plain
from puma_septic.quantities import QUANTITIES

__all__ = ["AT_LIMIT", "HEIGHT", "Kind", "LimitCheck", "most_used_first"]

AT_LIMIT: Final = 1e-9
"""A demand that exceeds its limit by no more than this part of the limit is at the limit, and keeps it.

It is five times what the arithmetic of a profile made at its limits leaves (2e-10 at most for `double_s` through
20 points with random limits), and far below any datum. A position, whose margin is a distance, keeps its bound if it
is beyond it by no more than this in rad (or m), the slack that inverse kinematics allows.
"""

HEIGHT: Final = "height"
"""The quantity of a check against a floor, which no joint has a limit of."""

# The fields of a check that are numbers, which JSON has no infinity for.
_NUMBERS: Final = ("demand", "limit", "time", "utilisation", "margin")

Kind = Literal["joint limit", "physics", "vendor procedure", "rule of thumb"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LimitCheck:
    """One demand of one joint or its drive train checked against one limit.

    Attributes
    ----------
    joint : str
        Of a height, the lowest part: a joint or the tool frame.
    quantity : str
        A name in `puma_septic.quantities.QUANTITIES`, "height", or what a drive train's check is called, "motor speed".
    demand : float
        The magnitude asked for, infinite where unbounded; for positions the extreme position.
    limit : float
        The magnitude allowed; for positions the bound nearest to being violated. NaN where it is not known and the
        demand, an infinite acceleration or effort, exceeds whatever it is.
    unit : str
        Of both.
    time : float
        Instant of the demand, s; NaN for what is a mean over the cycle.
    utilisation : float
        ``demand / limit``, infinite for an infinite demand and against a limit of zero; for positions the distance from
        the middle of the range over half the range (where only one bound is known: 0 within it, infinite beyond).
    margin : float
        ``1 - utilisation``; for positions the distance to the bound in rad (or m). Negative where violated.
    kind : {"joint limit", "physics", "vendor procedure", "rule of thumb"}
        What happens beyond the limit: the robot's own limit of the joint is violated; it cannot be; its maker does not
        vouch for it; it is merely unusual.
    source : str
        Where the limit or its rule comes from; "" where that is not known.
    case : str
        The load case of the demand, where there are several.

    Examples
    --------
    >>> check = LimitCheck.of_magnitude(
    ...     joint="elbow", quantity="velocity", demand=2.0, limit=2.5, unit="rad/s", time=0.4)
    >>> check.is_violated, check.keeps(margin=0.1), check.keeps(margin=0.25)
    (False, True, False)
    >>> print(check)
    elbow velocity 2 rad/s at t = 0.4 s is 80 % of 2.5 rad/s
    """

    joint: str
    quantity: str
    demand: float
    limit: float
    unit: str
    time: float
    utilisation: float
    margin: float
    kind: Kind = "joint limit"
    source: str = ""
    case: str = ""

    @classmethod
    def of_magnitude(
        cls,
        *,
        joint: str,
        quantity: str,
        demand: float,
        limit: float,
        unit: str,
        time: float,
        kind: Kind = "joint limit",
        source: str = "",
    ) -> Self:
        """A magnitude against the largest one allowed.

        Returns
        -------
        LimitCheck
        """
        utilisation = inf if isinf(demand) or limit == 0 else demand / limit
        return cls(
            joint=joint,
            quantity=quantity,
            demand=demand,
            limit=limit,
            unit=unit,
            time=time,
            utilisation=utilisation,
            margin=1 - utilisation,
            kind=kind,
            source=source,
        )

    @classmethod
    def of_position(
        cls,
        *,
        joint: str,
        bounds: tuple[float, float],
        reach: tuple[float, float],
        times: tuple[float, float],
        unit: str,
        source: str = "",
    ) -> Self:
        """Least and greatest position, and their instants, against the bound that they come nearest to or exceed most.

        A bound that is not known is NaN; one of both is known.

        Returns
        -------
        LimitCheck
        """
        (lower, upper), (least, greatest) = bounds, reach
        below, above = least - lower, upper - greatest
        side = 0 if isnan(above) or below < above else 1
        demand, margin = reach[side], (below, above)[side]
        # With one bound there is no range to use: all is well within it, nothing beyond.
        utilisation = 0.0 if margin >= -AT_LIMIT else inf
        if isfinite(lower) and isfinite(upper):
            utilisation = abs(demand - (lower + upper) / 2) / ((upper - lower) / 2)
        return cls(
            joint=joint,
            quantity="position",
            demand=demand,
            limit=bounds[side],
            unit=unit,
            time=times[side],
            utilisation=utilisation,
            margin=margin,
            source=source,
        )

    @classmethod
    def of_height(cls, *, part: str, height: float, floor: float, time: float) -> Self:
        """Height of the lowest part of an arm, a joint or its tool frame, against a floor, m.

        Returns
        -------
        LimitCheck
        """
        margin = height - floor
        return cls(
            joint=part,
            quantity=HEIGHT,
            demand=height,
            limit=floor,
            unit="m",
            time=time,
            utilisation=0.0 if margin >= -AT_LIMIT else inf,
            margin=margin,
            source="floor",
        )

    @property
    def is_violated(self) -> bool:
        """Whether the demand exceeds the limit by more than `AT_LIMIT`."""
        return not self.margin >= -AT_LIMIT

    def keeps(self, margin: float = 0.0) -> bool:
        """Whether the demand stays below ``(1 - margin) * limit``.

        A position has to stay within its bounds, whatever the margin: its distance to a bound is an angle, no share of
        anything.

        Returns
        -------
        bool
        """
        return self.margin >= (0.0 if self.is_range else margin) - AT_LIMIT

    @property
    def label(self) -> str:
        """What sentences call the quantity: the effort of a revolute joint is a torque, of a prismatic one a force."""
        row = QUANTITIES.get(self.quantity)
        return self.quantity if row is None else row.labels[row.units.index(self.unit)]

    @property
    def limit_text(self) -> str:
        """The limit in words."""
        return "whatever the limit" if isnan(self.limit) else f"limit {self.limit:.4g} {self.unit}".rstrip()

    @property
    def is_range(self) -> bool:
        """Whether the limit is a bound, and the margin a distance from it: so for positions and heights."""
        return self.quantity == HEIGHT or (self.quantity in QUANTITIES and QUANTITIES[self.quantity].is_range)

    def __repr__(self) -> str:
        return f"<LimitCheck: {self}>"

    def __str__(self) -> str:
        when = ("" if isnan(self.time) else f" at t = {self.time:.4g} s") + (f" of {self.case!r}" if self.case else "")
        kind = "" if self.kind == "joint limit" else f" ({self.kind})"
        if isinf(self.demand):
            return f"{self.joint} {self.label} unbounded{when}, {self.limit_text}{kind}"
        what = f"{self.joint} {self.label} {self.demand:.4g} {self.unit}".rstrip() + when
        limit = f"{self.limit:.4g} {self.unit}".rstrip()
        if self.quantity == HEIGHT:
            side = "below" if self.is_violated else "above"
            return f"{what} is {abs(self.margin):.4g} {self.unit} {side} the floor at {limit}"
        if self.is_range:
            side = "beyond" if self.is_violated else "from"
            return f"{what} is {abs(self.margin):.4g} {self.unit} {side} its bound {limit}"
        return f"{what} is {100 * self.utilisation:.4g} % of {limit}{kind}"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: "unbounded" for infinity, null for what is not known; the load case only where there is one.

        Returns
        -------
        dict
        """
        document = {field.name: plain(getattr(self, field.name)) for field in fields(self)}
        return document if self.case else {key: value for key, value in document.items() if key != "case"}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Self:
        """The check that `to_dict` wrote.

        Returns
        -------
        LimitCheck
        """
        numbers = {name: numeric(document[name]) for name in _NUMBERS}
        return cls(**{**document, **numbers})


def most_used_first(checks: Iterable[LimitCheck]) -> tuple[LimitCheck, ...]:
    """In order of utilisation; of two that agree to nine digits the one that is made first, whatever rounding says.

    Returns
    -------
    tuple of LimitCheck
    """
    return tuple(sorted(checks, key=lambda check: -float(f"{check.utilisation:.9g}")))
