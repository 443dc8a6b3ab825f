"""Straight lines, arcs and circles."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError
from puma_septic.kinematics import checked_poses
from puma_septic.paths._fitting import fit_state
from puma_septic.paths._path import Path
from puma_septic.paths._rotations import about, shortest_turn, turn_between, turned
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array, checked_array, checked_choice, checked_direction, checked_number, n_dimensions

__all__ = ["Orientation", "arc", "checked_pose", "circle", "line", "turning"]

Orientation = Literal["geodesic", "held", "tangent"]
# Two points closer than this, in m, are one: a line between them has no direction to nine digits.
_SAME_POINT = 1e-9
# The sine of the angle at which three points lie on a line: the radius is then 1e9 times their distance.
_COLLINEAR = 1e-9
# Orientations that differ by less, in rad, are the same one, written with few digits.
_SAME_TURN = 1e-6


def line(T_from: ArrayLike, T_to: ArrayLike, *, turn_axis: ArrayLike | None = None) -> Path:
    r"""A straight line of the tool, its orientation along the geodesic.

    With the length L, the direction d and the turn of angle :math:`\theta` about the world axis e that takes one
    orientation into the other,

    .. math:: p(s) = p_0 + s\,d, \qquad R(s) = \exp(\theta s/L\; e)\, R_0 .

    Parameters
    ----------
    T_from : array_like, shape (4, 4)
        Pose of the tool at the start, lengths in m.
    T_to : array_like, shape (4, 4) or (3,)
        Pose at the end, or its position, where the orientation is held.
    turn_axis : array_like, shape (3,), optional
        World axis of the turn, on the side that it goes round: needed for half a turn; the opposite of the geodesic's
        axis goes the long way round.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        For poses that are not rigid, equal positions, half a turn without `turn_axis`, an axis that does not turn one
        orientation into the other.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> way = paths.line(np.eye(4), [0.3, 0.4, 0.0])
    >>> float(way.length), way.frames(0.25)[:3, 3].round(12).tolist()
    (0.5, [0.15, 0.2, 0.0])
    """
    rotation, start = checked_pose("T_from", T_from)
    final, end = checked_pose("T_to", T_to) if n_dimensions(T_to) == 2 else (rotation, _checked_point("T_to", T_to))
    length = float(np.linalg.norm(end - start))
    if length <= _SAME_POINT:
        raise InputError(
            f"line: T_from and T_to have the same position, {start.tolist()} m ({length:.3g} m apart): a line needs a"
            " length; turn the tool on the spot by a joint move"
        )
    axis, angle = turning("line", rotation, final, turn_axis)
    breaks = [0.0, length]
    return Path(
        kind="line",
        position=Piecewise.from_power(breaks, np.stack([start, end - start])[:, None]),
        turns=Piecewise.from_power(breaks, [[[0.0, 0.0]], [[angle, 0.0]]]),
        axes=np.stack([axis, np.zeros(3)])[None],
        rotations=rotation[None],
    )


def arc(T_from: ArrayLike, via: ArrayLike, T_to: ArrayLike, *, orientation: Orientation = "geodesic") -> Path:
    """The arc of the circle through three points.

    Parameters
    ----------
    T_from : array_like, shape (4, 4)
        Pose of the tool at the start, lengths in m.
    via : array_like, shape (3,) or (4, 4)
        A point that the arc passes; of a pose the position counts alone.
    T_to : array_like, shape (4, 4) or (3,)
        Pose at the end, or its position, where the orientation is held or tangent.
    orientation : {"geodesic", "held", "tangent"}
        Turned evenly along the geodesic; the same all the way; turned with the path, so that the tool keeps its angle
        to the direction of travel. A pose `T_to` must agree with the last two.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        For points that are equal or lie on a line, poses that are not rigid or disagree with `orientation`, half a
        turn along the geodesic.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> half = paths.arc(np.eye(4), [1.0, 1.0, 0.0], [2.0, 0.0, 0.0], orientation="held")
    >>> round(half.length / np.pi, 12), float(half.curvature(1.0).round(9))
    (1.0, 1.0)
    """
    rotation, start = checked_pose("T_from", T_from)
    middle = checked_pose("via", via)[1] if n_dimensions(via) == 2 else _checked_point("via", via)
    final, end = checked_pose("T_to", T_to) if n_dimensions(T_to) == 2 else (None, _checked_point("T_to", T_to))
    centre, axis, angle = _circle_through(start, middle, end)
    return _round("arc", rotation, start, centre, axis, angle, orientation, final)


def circle(
    T_from: ArrayLike,
    *,
    centre: ArrayLike,
    axis: ArrayLike,
    angle: float = 2 * np.pi,
    orientation: Literal["held", "tangent"] = "held",
) -> Path:
    """The tool carried round an axis, from where it is.

    Parameters
    ----------
    T_from : array_like, shape (4, 4)
        Pose of the tool at the start, lengths in m.
    centre : array_like, shape (3,)
        A point of the axis, m.
    axis : array_like, shape (3,)
        World axis, of any length; the tool goes round it by the right-hand rule.
    angle : float
        rad, not zero; negative for the other way round; more than a turn goes round again.
    orientation : {"held", "tangent"}
        The same all the way, or turned with the path.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        For an axis of no length, a start on the axis, an angle of zero, a pose that is not rigid.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> way = paths.circle(np.eye(4), centre=[1, 0, 0], axis=[0, 0, 1], orientation="tangent")
    >>> way.frames(way.length / 2)[:2, 3].round(9).tolist()
    [2.0, -0.0]
    """
    rotation, start = checked_pose("T_from", T_from)
    centre, axis = checked_array("centre", centre, (3,), unit="m"), checked_direction("axis", axis)
    angle = checked_number("angle", angle, unit="rad")
    checked_choice("orientation", orientation, ("held", "tangent"))
    checked_number("the magnitude of angle", abs(angle), unit="rad", above=0.0)
    unit = axis * np.sign(angle)
    foot = centre + ((start - centre) @ unit) * unit
    return _round("circle", rotation, start, foot, unit, abs(angle), orientation, None)


def checked_pose(name: str, pose: ArrayLike) -> tuple[Array, Array]:
    """Rotation (3, 3) and position (3,) of a rigid transform."""
    columns = checked_poses(name, checked_array(name, pose, (4, 4))[None])[:, :, 0]
    return columns[:3].T.copy(), columns[3].copy()


def turning(what: str, start: Array, end: Array, axis: ArrayLike | None) -> tuple[Array, float]:
    """World axis and angle of the turn between two orientations, about the given axis or along the geodesic."""
    if axis is None:
        return shortest_turn(start, end, what)
    return about(start, end, checked_direction("turn_axis", axis), what)


def _checked_point(name: str, point: ArrayLike) -> Array:
    return checked_array(name, point, (3,), unit="m")


def _circle_through(start: Array, middle: Array, end: Array) -> tuple[Array, Array, float]:
    """Centre, unit axis and angle (0, 2 pi) of the arc from start over middle to end."""
    a, b = middle - start, end - start
    sides = [float(np.linalg.norm(side)) for side in (a, end - middle, b)]
    if min(sides) <= _SAME_POINT:
        pair = ("T_from and via", "via and T_to", "T_from and T_to")[int(np.argmin(sides))]
        whole = "; for a whole circle use circle" if pair == "T_from and T_to" else ""
        raise InputError(f"arc: {pair} are the same point ({min(sides):.3g} m apart){whole}")
    normal = np.cross(a, b)
    height = float(np.linalg.norm(normal))
    if height <= _COLLINEAR * sides[0] * sides[2]:
        raise InputError(
            f"arc: {start.tolist()}, {middle.tolist()} and {end.tolist()} m lie on a line, no circle passes them;"
            " move via aside, or use line"
        )
    centre = start + np.cross((a @ a) * b - (b @ b) * a, normal) / (2 * height**2)
    axis, arm = normal / height, start - centre
    angle = np.arctan2(np.cross(arm, end - centre) @ axis, arm @ (end - centre)) % (2 * np.pi)
    return centre, axis, float(angle)


def _round(
    kind: str,
    rotation: Array,
    start: Array,
    centre: Array,
    axis: Array,
    angle: float,
    orientation: Orientation,
    final: Array | None,
) -> Path:
    """A path round an axis through `centre`, the foot of `start` on it."""
    checked_choice("orientation", orientation, ("geodesic", "held", "tangent"))
    arm = start - centre
    radius = float(np.linalg.norm(arm))
    if radius <= _SAME_POINT:
        raise InputError(f"{kind}: T_from lies on the axis ({radius:.3g} m off it): the circle has no radius")
    turn_axis, turn = axis, angle if orientation == "tangent" else 0.0
    if orientation == "geodesic":
        if final is None:
            raise InputError(
                f"{kind}: T_to is a point; orientation 'geodesic' needs a pose: give one, or orientation='held'"
                " or 'tangent'"
            )
        turn_axis, turn = shortest_turn(rotation, final, kind)
    elif final is not None:
        _check_agrees(kind, orientation, turned(axis, np.array(turn), rotation.T).T, final)
    position = _round_position(centre, arm, np.cross(axis, arm), radius, radius * angle)
    n = len(position.breaks) - 1
    share = position.breaks / position.duration
    turns = np.zeros((2, n, 2))
    turns[0, :, 0], turns[1, :, 0] = turn * share[:-1], turn * np.diff(share)
    return Path(
        kind=kind,
        position=position,
        turns=Piecewise.from_power(position.breaks, turns),
        axes=np.tile(np.stack([turn_axis, np.zeros(3)]), (n, 1, 1)),
        rotations=np.tile(rotation, (n, 1, 1)),
    )


def _round_position(centre: Array, x: Array, y: Array, radius: float, length: float) -> Piecewise:
    """``centre + cos(s/r) x + sin(s/r) y``, its derivatives to rounding."""

    def sample(_: NDArray[np.int64], place: Array) -> Array:
        angle = (place + 1) / 2 * length / radius
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        around = [(c * x + s * y), (c * y - s * x) / radius]
        return np.stack([centre + around[0], around[1], -around[0] / radius**2, -around[1] / radius**2])

    def too_long(_: float) -> InputError:
        return InputError(
            f"angle = {length / radius:g} rad: more turns than one path can hold; follow fewer, repeatedly"
        )

    return fit_state(sample, np.array([0.0, length]), too_long)


def _check_agrees(kind: str, orientation: str, reached: Array, final: Array) -> None:
    _, off = turn_between(reached, final)
    if off > _SAME_TURN:
        raise InputError(
            f"{kind}: with orientation={orientation!r} the tool arrives {off:.6g} rad off the orientation of T_to;"
            " give T_to as a point, or orientation='geodesic'"
        )
