"""The friction law of a joint: the torque against its motion, of its velocity and of the way that it travels.

A term is added here: in `Friction` with its unit, in `_law`, where all laws are evaluated, and in `Friction.reflected`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import card, known, one_line
from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array, checked_array, frozen, store_numbers

__all__ = [
    "FRICTION_TERMS",
    "ROUNDING",
    "Friction",
    "checked_levels",
    "dry_friction_along",
    "friction_function",
    "friction_terms",
    "loss",
    "loss_along",
    "resolved",
]

FRICTION_TERMS: Final = ("viscous", "coulomb")
"""The parts of a friction torque, as `friction_terms` names them; "coulomb" is all dry friction."""


ROUNDING: Final = 1e-11
"""Of the arm's largest load: the tolerance to which `Piecewise.fit` resolves one."""


def _no_levels() -> Array:
    return np.full(2, np.nan)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Friction:
    """Friction on one side of the gears, of the joint's velocity v and its way (k = 0 forward, 1 backward).

    ``viscous v + coulomb[k] + (static[k] - coulomb[k]) exp(-(v / stribeck_velocity)^2)``,

    Coulomb and viscous friction, and as an option that of Stribeck: dry friction falls from its static level as the
    surfaces begin to slide (Armstrong-Helouvry, Dupont, Canudas de Wit, "A survey of models, analysis tools and
    compensation methods for the control of machines with friction", Automatica 30 (7), 1994, pp. 1083-1138; the
    Gaussian form). Gears whose friction grows with what they carry add ``load_share abs(load)`` against the motion
    (proportional to the load: Bittencourt, Gunnarsson, "Static friction in a robot joint: modeling and identification
    of load and temperature effects", J. Dyn. Sys., Meas., Control 134 (5), 2012, 051013); it is a factor of the load,
    see `transmission`, and no part of `torque`.

    The way a joint moves is that of its travel, not the sign of a velocity at an instant, which may be rounding. At
    rest dry friction can have any value within its band, and counts as 0.

    Parameters
    ----------
    viscous : float
        N m s/rad; NaN: unknown.
    coulomb : array_like, shape (2,)
        N m, for motion in the positive (>= 0) and the negative (<= 0) direction; NaN: unknown.
    static : array_like, shape (2,)
        N m, what must be overcome to move at all, no smaller than Coulomb friction; NaN: as large as that.
    stribeck_velocity : float
        rad/s, how quickly static friction gives way to Coulomb friction; NaN: at once, so that `static` holds at rest
        alone.
    load_share : float
        Friction over the load that the gears carry, 0 to 1; NaN: no such term.

    Raises
    ------
    InputError
        For friction that would drive, or a static level without or below a Coulomb level.

    Examples
    --------
    >>> friction = Friction(viscous=1e-3, coulomb=[0.4, -0.5])
    >>> friction.torque([10.0, -10.0, 0.0], [1, -1, 0]).tolist()
    [0.41000000000000003, -0.51, 0.0]
    >>> friction.reflected(-100.0).coulomb.tolist()
    [40.0, -50.0]
    >>> sticky = Friction(viscous=0.0, coulomb=[0.4, -0.5], static=[0.6, -0.5], stribeck_velocity=2.0)
    >>> sticky.torque([0.0, 2.0, 20.0], [1, 1, 1]).round(4).tolist()  # 0.4 + 0.2/e in the middle
    [0.6, 0.4736, 0.4]
    """

    viscous: float = np.nan
    coulomb: Array = field(default_factory=_no_levels)
    static: Array = field(default_factory=_no_levels)
    stribeck_velocity: float = np.nan
    load_share: float = np.nan

    def __post_init__(self) -> None:
        store_numbers(self, {"viscous": "N m s/rad"}, at_least=0.0)
        store_numbers(self, {"stribeck_velocity": "rad/s"}, above=0.0)
        store_numbers(self, {"load_share": ""}, at_least=0.0, at_most=1.0)
        for name in ("coulomb", "static"):
            object.__setattr__(self, name, checked_levels(name, getattr(self, name)))
        if np.isfinite(self.static).any():
            self._check_static()

    def _check_static(self) -> None:
        if not (np.abs(self.static) >= np.abs(self.coulomb)).all():
            raise InputError(
                f"static = {self.static.tolist()} N m with coulomb = {self.coulomb.tolist()} N m: static friction must"
                " be known in both directions and no smaller than Coulomb friction, which it needs"
            )

    @property
    def is_known(self) -> bool:
        """Whether viscous and Coulomb friction are; the other terms are options."""
        return not (np.isnan(self.viscous) or np.isnan(self.coulomb).any())

    @property
    def is_linear(self) -> bool:
        """Whether the torque is a sum of velocity, direction and load, each times a constant: so without Stribeck."""
        return not self.excess.any()

    @property
    def known(self) -> Friction:
        """The same law with what is unknown left out."""
        return replace(self, viscous=float(np.nan_to_num(self.viscous)), coulomb=np.nan_to_num(self.coulomb))

    @property
    def band(self) -> Array:
        """What friction can carry at rest in either direction, N m, shape (2,): the static level, else Coulomb's."""
        return frozen(np.nan_to_num(np.where(np.isnan(self.static), self.coulomb, self.static)))

    @property
    def transmission(self) -> Array:
        """Factors of the load where it drives, at rest, and where the motor drives, shape (3,): ``1 -+ load_share``."""
        share = np.nan_to_num(self.load_share)
        return frozen(np.array([1 - share, 1.0, 1 + share]))

    @property
    def excess(self) -> Array:
        """What static friction has beyond Coulomb friction while the joint moves, shape (2,)."""
        return frozen(np.zeros(2) if np.isnan(self.stribeck_velocity) else np.nan_to_num(self.static - self.coulomb))

    def is_same(self, other: Friction) -> bool:
        """Whether all numbers are equal, unknown ones too."""
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return all(np.array_equal(one, two, equal_nan=True) for one, two in pairs)

    def reflected(self, ratio: float) -> Friction:
        """The same friction on the slower side of gears with this ratio, N m s/rad and N m there.

        The direction is the joint's on both sides, so that the sign of the ratio does not exchange the dry parts.

        Returns
        -------
        Friction
        """
        return replace(
            self,
            viscous=self.viscous * ratio**2,
            coulomb=self.coulomb * abs(ratio),
            static=self.static * abs(ratio),
            stribeck_velocity=self.stribeck_velocity / abs(ratio),
        )

    def torque(self, velocity: ArrayLike, moving: ArrayLike) -> Array:
        """Torque that overcomes the friction, N m; what is unknown is left out, and so is what depends on the load.

        It steps where `moving` does; a simulation that cannot bear this smooths `moving`, which may be any number from
        -1 to 1 there.

        Parameters
        ----------
        velocity, moving : array_like
            rad/s, and the sign of travel, 0 at rest; of one shape.

        Returns
        -------
        ndarray
        """
        v, way = checked_array("velocity", velocity, None), checked_array("moving", moving, None)
        terms = friction_terms((self,), v[..., None], way[..., None])
        return np.asarray(sum(terms.values())[..., 0])  # type: ignore[index]

    def along(self, velocity: Piecewise, moving: Array) -> Piecewise:
        """The same along a motion, exactly.

        Parameters
        ----------
        velocity : Piecewise
            Of one component, of one sign on each of its intervals, rounding apart.
        moving : ndarray, shape (n_intervals,)
            Sign of travel on each of its intervals.

        Returns
        -------
        Piecewise
            With breaks of its own where Stribeck friction has any.
        """
        dry = dry_friction_along((self,), velocity, velocity.stepwise(np.asarray(moving)[:, None]))
        return velocity * _law((self,)).viscous + dry

    def __repr__(self) -> str:
        return one_line("Friction", self._facts())

    def _repr_html_(self) -> str:
        return card("Friction", self._facts())

    def _facts(self) -> dict[str, object]:
        return known(
            self,
            {"viscous": "N m s/rad", "coulomb": "N m", "static": "N m", "stribeck_velocity": "rad/s", "load_share": ""},
        )


def checked_levels(name: str, value: ArrayLike) -> Array:
    """Two levels of dry friction in N m, of motion forward (>= 0) and backward (<= 0); NaN: unknown.

    Raises
    ------
    InputError
        For friction that would drive.
    """
    levels = checked_array(name, value, (2,), unit="N m", allow_nan=True)
    if levels[0] < 0 or levels[1] > 0:
        raise InputError(
            f"{name} = [{levels[0]:g}, {levels[1]:g}] N m: the first (positive velocity) must be >= 0 and the"
            " second (negative velocity) <= 0"
        )
    return levels


class _Law(NamedTuple):
    """The numbers of several joints side by side; what is unknown is 0, without Stribeck's its velocity infinite."""

    viscous: Array
    coulomb: Array
    excess: Array
    stribeck_velocity: Array

    def dry(self, levels: Array, moving: Array) -> Array:
        """The level of each joint by its way, shape (..., n_joints): a share of it where the way is between 0 and 1."""
        return np.asarray(np.maximum(moving, 0.0) * levels[:, 0] + np.maximum(-moving, 0.0) * levels[:, 1])

    def decay(self, velocity: Array) -> Array:
        """What is left of the excess at a velocity, 1 to 0."""
        return np.asarray(np.exp(-((velocity / self.stribeck_velocity) ** 2)))


@lru_cache(maxsize=64)
def _law(laws: tuple[Friction, ...]) -> _Law:
    """Kept, as a simulation asks for the same joints at every step."""
    width = np.array([law.stribeck_velocity for law in laws])
    return _Law(
        viscous=np.nan_to_num([law.viscous for law in laws]),
        coulomb=np.nan_to_num([law.coulomb for law in laws]),
        excess=np.array([law.excess for law in laws]),
        stribeck_velocity=np.where(np.isnan(width), np.inf, width),
    )


def friction_terms(laws: Sequence[Friction], velocity: Array, moving: Array) -> dict[str, Array]:
    """Friction of several joints by `FRICTION_TERMS`, at velocities and ways of shape (..., n_joints).

    Returns
    -------
    dict of str to ndarray
        N m (N for prismatic joints), of the shape of `velocity`; what depends on the load is not in it.
    """
    law = _law(tuple(laws))
    dry = law.dry(law.coulomb, moving)
    if law.excess.any():
        dry = dry + law.dry(law.excess, moving) * law.decay(velocity)
    return {"viscous": law.viscous * velocity, "coulomb": dry}


def friction_function(laws: Sequence[Friction]) -> Callable[[Array, Array], Array]:
    """The sum of `friction_terms` of several joints, with as little as possible left to do at each call.

    Returns
    -------
    callable
        Of velocities and ways of shape (..., n_joints): N m (N).
    """
    law = _law(tuple(laws))
    viscous, has_excess = law.viscous, bool(law.excess.any())
    if not has_excess and not law.coulomb.any():
        return lambda velocity, _: viscous * velocity

    def friction(velocity: Array, moving: Array) -> Array:
        torque = viscous * velocity + law.dry(law.coulomb, moving)
        return torque + law.dry(law.excess, moving) * law.decay(velocity) if has_excess else torque

    return friction


def dry_friction_along(laws: Sequence[Friction], velocity: Piecewise, direction: Piecewise) -> Piecewise:
    """Dry friction along a motion, exactly: the term "coulomb" of `friction_terms`.

    Parameters
    ----------
    laws : sequence of Friction
        One per joint.
    velocity, direction : Piecewise
        With a component per joint; the direction is constant on each of its intervals, +1, -1, or 0 at rest.

    Returns
    -------
    Piecewise
    """
    law, ways = _law(tuple(laws)), direction.coefficients[0]
    dry = direction.stepwise(law.dry(law.coulomb, ways))
    if law.excess.any():
        # Between the turns of the velocity its decay has no peak inside an interval, where a fit could miss it.
        sticky = np.flatnonzero(law.excess.any(axis=1)).tolist()
        turns = [velocity[j].derivative().roots()[0] for j in sticky]
        split = velocity.aligned_with(direction).split(np.concatenate(turns))
        dry = dry + split.mapped(law.decay) * direction.stepwise(law.dry(law.excess, ways))
    return dry


def loss(transmission: Array, load: Array, moving: Array) -> Array:
    """What is lost of the loads of several joints on their way through the gears, ``(transmission - 1) load``.

    Parameters
    ----------
    transmission : ndarray, shape (n_joints, 3)
        Factors of the load where it drives, at rest, and where the motor drives.
    load, moving : ndarray, shape (n, n_joints)
        N m (N), and the sign of travel, 0 at rest.

    Returns
    -------
    ndarray, shape (n, n_joints)
    """
    return np.asarray((_passed(transmission, np.sign(load) * np.sign(moving)) - 1) * load)


def loss_along(transmission: Array, load: Piecewise, direction: Piecewise) -> Piecewise:
    """The same along a motion, exactly.

    Returns
    -------
    Piecewise
        With breaks of its own where a load changes sign.
    """
    rounding = ROUNDING * load.bounds().max()
    moved = resolved(load, rounding).aligned_with(direction)
    ways = direction.aligned_with(moved).coefficients[0]
    # A joint at rest loses nothing, whatever the sign of its load.
    split = moved.by_interval(np.abs(ways)).split_at_roots()
    power_sign = direction.aligned_with(split).coefficients[0] * split.signs()
    return split.by_interval(_passed(transmission, power_sign) - 1)


def resolved(load: Piecewise, rounding: float) -> Piecewise:
    """A load that is exactly 0 on the intervals on which it is rounding, which has no sign.

    Returns
    -------
    Piecewise
    """
    return load.by_interval(load.bounds() > rounding)


def _passed(transmission: Array, power_sign: Array) -> Array:
    return np.asarray(transmission[np.arange(len(transmission)), power_sign.astype(int) + 1])
