"""What Pinocchio made of a checked URDF: complete, and whose torque can be computed."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from puma_septic.robot._mimic import inertia_matrices
from puma_septic.robot._urdf_checks import Urdf
from puma_septic.robot._urdf_schema import tensor, vector
from puma_septic.validation import Array

__all__ = ["check_complete", "massless_notes", "unknown_torques"]

N_CONFIGURATIONS: Final = 20
SEED: Final = 560
SINGULAR: Final = 1e-12  # of a matrix with unit diagonal: rounding leaves some 1e-16 of a zero eigenvalue
FAR: Final = 1e3  # rad or m: a limit beyond it is a placeholder such as 1e16
SAME_BODY: Final = 1e-9  # rounding of sums of at most 200 terms, of their magnitudes
NO_INERTIA: Final = 1e-12  # kg m^2 (kg for prismatic joints), far below a watch's hand


def check_complete(model: pin.Model, urdf: Urdf) -> None:
    """Compare the joints, and each one's body, with the text: a second look at what the first door let through.

    Raises
    ------
    ModelError
        If Pinocchio lost or added a joint, or reads another mass, centre or inertia than the text has.
    """
    names, expected = list(model.names)[1:], [*urdf.moving, *urdf.mimics]
    if sorted(names) != sorted(expected) or model.nv != len(urdf.moving):
        raise urdf.text.complaint(f"Pinocchio reads the joints {names}, the text has {expected}")
    for name, (moments, sizes) in _bodies(urdf).items():
        read = _moments(model.inertias[model.getJointId(name) if name else 0])
        # Each held against the largest of its kind: beside that, its own zeros are rounding.
        scale = np.repeat([part.max() for part in np.split(sizes, (1, 4))], (1, 3, 9))
        wrong = np.flatnonzero(~(np.abs(read - moments) <= SAME_BODY * scale + NO_INERTIA))
        if len(wrong):
            k = int(wrong[0])
            what = "a mass" if k == 0 else "a centre of mass" if k < 4 else "an inertia"
            raise urdf.text.complaint(
                f"of the body of {f'joint {name!r}' if name else 'the base'} Pinocchio reads {what} other than the"
                f" text's: {read[k]:g} instead of {moments[k]:g} (kg, kg m, kg m^2)"
            )


def _bodies(urdf: Urdf) -> dict[str, tuple[Array, Array]]:
    """`_body_moments` of what each joint carries up to the next ones ("": the base), and sums of their magnitudes."""
    found = {name: (np.zeros(13), np.zeros(13)) for name in ("", *urdf.moving, *urdf.mimics)}
    for name, link in urdf.links.items():
        inertial, matrix = link.find("inertial"), link.find("inertial/inertia")
        if inertial is not None and matrix is not None:
            carrier, pose = _carried(urdf, name)
            at = pose * _origin(inertial.find("origin"))
            mass = vector(inertial.find("mass"), "value", ())[0]
            part = _body_moments(mass, at.translation, at.rotation @ tensor(matrix) @ at.rotation.T)
            moments, sizes = found[carrier]
            moments += part
            sizes += np.abs(part)
    return found


def _carried(urdf: Urdf, link: str) -> tuple[str, pin.SE3]:
    """The joint that carries a link ("": the base), and where the link is in that joint's frame."""
    pose, above = pin.SE3.Identity(), urdf.above
    while link in above and above[link].kind == "fixed":
        pose = _origin(above[link].element.find("origin")) * pose
        link = above[link].parent
    return above[link].name if link in above else "", pose


def _origin(element: ET.Element | None) -> pin.SE3:
    """The pose that an <origin> says."""
    zero = (0.0, 0.0, 0.0)
    return pin.SE3(pin.rpy.rpyToMatrix(vector(element, "rpy", zero)), vector(element, "xyz", zero))


def _moments(inertia: pin.Inertia) -> Array:
    return _body_moments(inertia.mass, inertia.lever, inertia.inertia)


def _body_moments(mass: float, centre: Array, inertia: Array) -> Array:
    """Mass, first and second moments about the joint's origin, shape (13,): those of two bodies add up."""
    second = inertia + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return np.array([mass, *(mass * centre), *second.ravel()])


def unknown_torques(model: pin.Model, armature: Array, urdf: Urdf) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Joints whose torque cannot be computed, in the order of the text, and notes of why.

    They are those that move no inertia at all (20 seeded configurations), those that carry a link whose inertia no body
    can have, and all of them where the joint-space inertia, rotors included, is not positive definite: no acceleration
    belongs to a torque then.

    Parameters
    ----------
    model : pinocchio.Model
        Without armature.
    armature : ndarray, shape (nv,)
        Rotor inertia at the joint in Pinocchio's order, 0 where unknown.
    urdf : Urdf
    """
    inertias = _inertias(model, urdf)
    present = ~(np.diagonal(inertias, axis1=1, axis2=2).max(axis=0) <= NO_INERTIA)
    joints = zip(list(model.joints)[1:], list(model.names)[1:], strict=True)  # the first is the world
    empty = {name for joint, name in joints if joint.nv == 1 and not present[joint.idx_v]}
    carriers = _unsound_carriers(urdf)
    if not _is_positive_definite(inertias + np.diag(armature), present):
        note = (
            "the joint-space inertia is not positive definite: masses and inertias are not those of bodies; no torque"
        )
        return urdf.moving, (note,)
    missing = tuple(name for name in urdf.moving if name in empty or name in carriers)
    told = ", ".join(map(repr, urdf.unusable))
    is_told = any(name in carriers for name in urdf.moving)
    notes = (f"torque not known of what carries {told}, whose inertia is not usable",) if is_told else ()
    return missing, notes


def massless_notes(model: pin.Model, urdf: Urdf) -> Iterator[str]:
    """Note each moving joint whose own body (with all that is fixed to it) has neither mass nor inertia."""
    for name in (*urdf.moving, *urdf.mimics):
        body = model.inertias[model.getJointId(name)]
        if body.mass == 0 and not body.inertia.any() and urdf.joints[name].child not in urdf.unusable:
            yield f"link {urdf.joints[name].child!r}: moves, but the URDF has no inertia for it; massless"


def _unsound_carriers(urdf: Urdf) -> set[str]:
    """Joints that carry a link whose inertia is not usable, those that drive them by a coupling with them."""
    carrying = {name for link in urdf.unusable for name in urdf.carriers(link)}
    return carrying | {mimic.master for name, mimic in urdf.mimics.items() if name in carrying}


def _inertias(model: pin.Model, urdf: Urdf) -> Array:
    return inertia_matrices(model, list(_configurations(model)), mimics=bool(urdf.mimics))


def _is_positive_definite(inertias: Array, present: NDArray[np.bool_]) -> bool:
    """Whether the inertia between the joints that move any is that of bodies."""
    inertias = inertias[:, present][:, :, present]
    diagonals = np.abs(np.diagonal(inertias, axis1=1, axis2=2))
    scales = np.sqrt(np.maximum(diagonals, NO_INERTIA))  # so that kg m^2 and kg compare
    lowest = np.linalg.eigvalsh(inertias / (scales[:, :, None] * scales[:, None, :]))[:, :1]
    return bool((lowest > SINGULAR).all())


def _configurations(model: pin.Model) -> Iterator[Array]:
    """Random ones within the position limits; a continuous joint anywhere on its circle."""
    lower, upper = np.full(model.nv, -np.pi), np.full(model.nv, np.pi)
    for joint in list(model.joints)[1:]:
        if joint.nq == 1:
            lower[joint.idx_v] = np.clip(model.lowerPositionLimit[joint.idx_q], -FAR, FAR)
            upper[joint.idx_v] = np.clip(model.upperPositionLimit[joint.idx_q], -FAR, FAR)
    rng = np.random.default_rng(SEED)
    for _ in range(N_CONFIGURATIONS):
        yield pin.integrate(model, pin.neutral(model), rng.uniform(lower, upper))
