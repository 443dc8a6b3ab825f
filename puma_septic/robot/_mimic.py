"""Joints that mimic another one: which coordinate moves them, and an order in which Pinocchio can read them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import final

import numpy as np
import pinocchio as pin

from puma_septic.validation import Array

__all__ = ["Mimic", "Tree", "followed", "inertia_matrices", "visiting_order"]

# Child joints of each link, and of each joint the link that it moves.
Tree = tuple[Mapping[str, Sequence[str]], Mapping[str, str]]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Mimic:
    """What moves a joint without a motor of its own: its position is ``multiplier * q[master] + offset``.

    Attributes
    ----------
    master : str
    multiplier : float
    offset : float
        rad (m where it slides).
    """

    master: str
    multiplier: float = 1.0
    offset: float = 0.0


def followed(name: str, given: Mapping[str, Mimic]) -> Mimic | None:
    """What a mimicking joint follows in the end, through others that mimic; None where they go in a circle."""
    multiplier, offset, seen, master = 1.0, 0.0, {name}, name
    while master in given:
        step = given[master]
        offset += multiplier * step.offset
        multiplier *= step.multiplier
        master = step.master
        if master in seen:
            return None
        seen.add(master)
    return Mimic(master=master, multiplier=multiplier, offset=offset)


def visiting_order(tree: Tree, root: str, mimics: Mapping[str, Mimic]) -> list[str] | None:
    """Joints depth first, each after the one that it mimics; None where no order of siblings does that.

    Pinocchio visits siblings by name and must have seen a joint before those that mimic it.
    """
    children, moved = tree

    def below(joint: str) -> Iterator[str]:
        yield joint
        for child in children.get(moved[joint], ()):
            yield from below(child)

    def visit(link: str) -> Iterator[str]:
        siblings = {joint: set(below(joint)) for joint in sorted(children.get(link, ()))}
        needed = {
            joint: [
                other
                for other in siblings
                if other != joint and any(mimics[one].master in siblings[other] for one in inside if one in mimics)
            ]
            for joint, inside in siblings.items()
        }
        for joint in TopologicalSorter(needed).static_order():
            yield joint
            yield from visit(moved[joint])

    try:
        order = list(visit(root))
    except CycleError:
        return None
    place = {joint: k for k, joint in enumerate(order)}
    return order if all(place[one.master] < place[name] for name, one in mimics.items()) else None


def inertia_matrices(model: pin.Model, configurations: Sequence[Array], *, mimics: bool) -> Array:
    """Joint-space inertia in each configuration, kg m^2 (kg), shape (n, nv, nv), in Pinocchio's order.

    By the composite-rigid-body algorithm. With mimicking joints that is wrong where two branches hang behind one, and
    adds to what the call before has left in the data (pin 4.1.0); there column j is the torque that the acceleration
    1 of joint j takes at rest without gravity, by the algorithm of Newton and Euler.
    """
    if mimics:
        free, still = model.copy(), np.zeros(model.nv)
        free.gravity = pin.Motion.Zero()
        data = free.createData()
        columns = [[pin.rnea(free, data, q, still, unit).copy() for unit in np.eye(model.nv)] for q in configurations]
        return np.array(columns).reshape(-1, model.nv, model.nv).transpose(0, 2, 1)
    data = model.createData()
    found = np.array([pin.crba(model, data, q).copy() for q in configurations]).reshape(-1, model.nv, model.nv)
    upper = np.triu(found)  # the triangle that it fills
    return np.asarray(upper + np.triu(upper, 1).transpose(0, 2, 1))
