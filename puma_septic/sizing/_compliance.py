"""How far gears that wind up, and gears with backlash, leave the tool from where the motors hold it; how it swings."""

from __future__ import annotations

import functools
import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import Any, Final, final

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.document import plain
from puma_septic.drives import Gearbox
from puma_septic.errors import InputError
from puma_septic.limit_check import LimitCheck
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._demands import Demands, Peak
from puma_septic.validation import Array, checked_number, frozen

__all__ = ["Compliance", "compliance", "windup"]

_UNKNOWN: Final = Peak(np.nan, np.nan)
_ARM: Final = "arm"
# The climb to the largest eigenvalue rises at every step; far fewer are ever needed.
_MOST_STEPS: Final = 60
_CONVERGED: Final = 1e-12
# Starting points per interval, among which the highest hill lies.
_STARTS: Final = 17
# Corners of the box of backlashes double with each joint.
_MOST_JOINTS: Final = 10


def windup(gearbox: Gearbox, torque: Piecewise) -> Piecewise:
    """Wind-up of the gears along a cycle, rad, signed as the torque: `Gearbox.torsion`, exactly between its bends.

    Parameters
    ----------
    gearbox : Gearbox
        Of known stiffness.
    torque : Piecewise
        At its output, N m, of one sign on each interval.

    Returns
    -------
    Piecewise
    """
    way = torque.signs()[:, 0]
    size = torque.by_interval(way)
    levels = (Piecewise.constant([limit], size.duration, start=size.start) for limit in gearbox.stiffness_torques)
    split = size.split(np.concatenate([np.empty(0), *((size - level).roots()[0] for level in levels)]))
    k = np.searchsorted(gearbox.stiffness_torques, split(split.middles)[:, 0])
    start = np.concatenate([[0.0], gearbox.stiffness_torques])
    offset = np.array([gearbox.torsion(limit) for limit in start.tolist()]) - start / gearbox.stiffness
    way = way[np.searchsorted(torque.breaks[1:-1], split.middles)]
    return split.by_interval(way / gearbox.stiffness[k]) + split.stepwise((way * offset[k])[:, None])


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Compliance:
    """Elastic gears of an arm over a cycle, the motors standing where they should.

    Computed when first asked for and kept (the cache needs a ``__dict__``, hence no slots).

    Attributes
    ----------
    cycle : Cycle
    demands : tuple of Demands
        One per joint.
    """

    cycle: Cycle
    demands: tuple[Demands, ...]

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self.cycle.joint_names

    @property
    def unknown_stiffness(self) -> tuple[str, ...]:
        """Joints whose gears' stiffness is not known."""
        return tuple(d.load.joint for d in self.demands if not len(d.train.gearbox.stiffness))

    @property
    def unknown_backlash(self) -> tuple[str, ...]:
        """Joints whose gears' backlash is not known."""
        return tuple(d.load.joint for d in self.demands if np.isnan(d.train.gearbox.backlash))

    @cached_property
    def _per_turn(self) -> Array:
        """Travel of the joint per turn of its gearbox's output: 1, or that of a stage per rad."""
        stages = [d.train.stage for d in self.demands]
        return np.array([1.0 if stage is None else 1 / stage.reduction for stage in stages])

    @cached_property
    def windups(self) -> tuple[Piecewise | None, ...]:
        """Of each joint, rad (m); None where the stiffness is not known."""
        return tuple(
            windup(d.train.gearbox, d.load.torque) * per if len(d.train.gearbox.stiffness) else None
            for d, per in zip(self.demands, self._per_turn.tolist(), strict=True)
        )

    @cached_property
    def peak_windup(self) -> tuple[Peak, ...]:
        """Largest of each joint, rad (m)."""
        return tuple(_UNKNOWN if one is None else _largest(one) for one in self.windups)

    @cached_property
    def tool_windup(self) -> Peak:
        """Largest shift of the tool's origin by the wind-up of all joints, m: ``|J phi|``."""
        if self.unknown_stiffness:
            return _UNKNOWN
        jacobian = self.cycle.tool_jacobian
        known = [one for one in self.windups if one is not None]
        shifts = [
            functools.reduce(operator.add, (jacobian[3 * j + axis] * phi for j, phi in enumerate(known)))
            for axis in range(3)
        ]
        return _norm(shifts)

    @cached_property
    def tool_backlash(self) -> Peak:
        """Largest shift of the tool's origin when each joint may be anywhere in its backlash, m.

        ``max |J b / 2|`` over both ends of every joint's: the largest of a convex function is at a corner.

        Raises
        ------
        InputError
            For more joints than corners can be counted of.
        """
        if self.unknown_backlash:
            return _UNKNOWN
        half = np.array([d.train.gearbox.backlash for d in self.demands]) * self._per_turn / 2
        moving = np.flatnonzero(half)
        if len(moving) > _MOST_JOINTS:
            raise InputError(
                f"{len(moving)} joints have backlash: more than {_MOST_JOINTS} are too many corners to try"
            )
        if not len(moving):
            return Peak(0.0, self.cycle.tool_jacobian.start)
        signs = np.array([(1.0, *rest) for rest in product((1.0, -1.0), repeat=len(moving) - 1)])
        jacobian = self.cycle.tool_jacobian
        series = jacobian.coefficients.reshape(*jacobian.coefficients.shape[:2], -1, 3)[:, :, moving]
        ends = np.einsum("dnjx,sj->dnxs", series, signs * half[moving])
        corners = [Piecewise(breaks=jacobian.breaks, coefficients=ends[:, :, axis]) for axis in range(3)]
        return _norm(corners)

    @cached_property
    def joint_frequencies(self) -> Array:
        """Of each joint alone, the others rigid, where its load is heaviest, Hz: ``sqrt(K / M_jj) / 2 pi``."""
        heaviest = np.array([float(d.load.inertia.extrema().max[0]) for d in self.demands])
        return frozen(np.asarray(np.sqrt(self._stiffness / heaviest) / (2 * np.pi)))

    @property
    def _stiffness(self) -> Array:
        """The least that each gearbox has, as it has it under little load: the lowest frequencies follow from it."""
        return np.array([float(np.min(d.train.gearbox.stiffness, initial=np.inf)) for d in self.demands])

    @cached_property
    def lowest_frequency(self) -> Peak:
        """Of the arm with all its gears elastic, the lowest along the cycle, Hz, and its instant.

        ``w^2`` is the least eigenvalue of ``K x = w^2 M(q) x``, so ``1 / w^2`` the largest of ``S M S`` with ``S =
        K^(-1/2)``. Of all x the largest ``x S M(q(t)) S x`` at one instant is that eigenvalue; of all instants the
        largest of a given x is an extremum of a series: taken in turns they climb to the top.
        """
        if self.unknown_stiffness:
            return _UNKNOWN
        scale = self._per_turn / np.sqrt(self._stiffness)
        n = len(scale)
        matrix = self.cycle.mass_matrix * np.outer(scale, scale).ravel()
        best = Peak(0.0, matrix.start)
        for time in _hills(matrix, n):
            best = max(best, _climbed(matrix, n, time))
        return Peak(float(1 / np.sqrt(best.size) / (2 * np.pi)), best.time)

    def checks(self, *, max_tool_error: float = np.nan, min_frequency: float = np.nan) -> tuple[LimitCheck, ...]:
        """What is asked of accuracy and of stiffness, checked; what is not known, or not asked for, is left out.

        Parameters
        ----------
        max_tool_error : float
            m, of wind-up and of backlash.
        min_frequency : float
            Hz.

        Returns
        -------
        tuple of LimitCheck
        """
        found = []
        rows = {"wind-up at the tool": self.tool_windup, "backlash at the tool": self.tool_backlash}
        if not np.isnan(max_tool_error):
            limit = checked_number("max_tool_error", max_tool_error, unit="m", above=0.0)
            found += [_check(name, peak, limit, "m") for name, peak in rows.items() if not np.isnan(peak.size)]
        if not np.isnan(min_frequency) and not np.isnan(self.lowest_frequency.size):
            asked = checked_number("min_frequency", min_frequency, unit="Hz", above=0.0)
            lowest = self.lowest_frequency
            # What is asked for is the demand, what there is the limit.
            found.append(_check("natural frequency", Peak(asked, lowest.time), lowest.size, "Hz"))
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: rad (m), m and Hz.

        Returns
        -------
        dict
        """
        numbers = {
            "tool_windup": self.tool_windup.size,
            "tool_windup_time": self.tool_windup.time,
            "tool_backlash": self.tool_backlash.size,
            "lowest_frequency": self.lowest_frequency.size,
            "lowest_frequency_time": self.lowest_frequency.time,
        }
        alone = np.where(np.isinf(self.joint_frequencies), np.nan, self.joint_frequencies).tolist()
        joints = [
            {"name": name, **plain({"windup": peak.size, "frequency": frequency})}
            for name, peak, frequency in zip(self.joints, self.peak_windup, alone, strict=True)
        ]
        return {**plain(numbers), "joints": joints}


def _check(quantity: str, peak: Peak, limit: float, unit: str) -> LimitCheck:
    return LimitCheck.of_magnitude(
        joint=_ARM, quantity=quantity, demand=peak.size, limit=limit, unit=unit, time=peak.time, kind="physics",
        source="elastic gears, motors at rest where they should be",
    )  # fmt: skip


def _largest(f: Piecewise) -> Peak:
    found = f.extrema()
    return Peak(float(found.peak[0]), float(found.t_peak[0]))


def _norm(parts: Sequence[Piecewise]) -> Peak:
    """Largest length of the vectors with these components, of all columns."""
    found = functools.reduce(operator.add, (part * part for part in parts)).extrema()
    k = int(np.argmax(found.max))
    return Peak(float(np.sqrt(max(found.max[k], 0.0))), float(found.t_max[k]))


def _hills(matrix: Piecewise, n: int) -> list[float]:
    """Instants at which the largest eigenvalue exceeds its neighbours, of a few on every interval."""
    x = np.cos(np.pi * (np.arange(_STARTS) + 0.5) / _STARTS)[::-1]
    offsets = matrix.offsets
    times = np.concatenate([(a + b) / 2 + (b - a) / 2 * x for a, b in pairwise(offsets)])
    tops = np.linalg.eigvalsh(matrix.at_offsets(times).reshape(-1, n, n))[:, -1]
    around = np.concatenate([[-np.inf], tops, [-np.inf]])
    found: list[float] = (matrix.start + times[(tops >= around[:-2]) & (tops >= around[2:])]).tolist()
    return found


def _climbed(matrix: Piecewise, n: int, time: float) -> Peak:
    best = Peak(0.0, time)
    for _ in range(_MOST_STEPS):
        vector = np.linalg.eigh(matrix(best.time).reshape(n, n))[1][:, -1]
        weights = np.outer(vector, vector).ravel()
        series = np.tensordot(matrix.coefficients, weights, 1)[..., None]
        found = Piecewise(breaks=matrix.breaks, coefficients=series).extrema()
        if not found.max[0] > best.size * (1 + _CONVERGED):
            break
        best = Peak(float(found.max[0]), float(found.t_max[0]))
    return best


def compliance(cycle: Cycle, demands: Sequence[Demands]) -> Compliance:
    """How elastic an arm's gears leave it over a cycle.

    Parameters
    ----------
    cycle : Cycle
    demands : sequence of Demands
        Of all its joints, as a `Sizing` has them.

    Returns
    -------
    Compliance

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> cycle = ps.cycle.with_return(there, dwell=1.0)
    >>> trains = [ps.Drivetrain(gearbox=ps.Gearbox(ratio=100.0, stiffness=[2e4])) for _ in range(6)]
    >>> found = compliance(cycle, ps.size(cycle, drivetrains=trains).demands)
    >>> 1e3 * found.tool_windup.size < 2.0, found.unknown_stiffness
    (True, ())
    """
    return Compliance(cycle=cycle, demands=tuple(demands))
