"""What Pinocchio made of a checked URDF: complete, and with a joint-space inertia that can be inverted."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from puma_septic.errors import ModelError
from puma_septic.robot.urdf_checks import Urdf
from puma_septic.robot.urdf_schema import vector
from puma_septic.validation import Array

__all__ = ["check_complete", "check_inertia", "massless_notes"]

N_CONFIGURATIONS = 20
SEED = 560
SINGULAR = 1e-12  # of a matrix with unit diagonal: rounding leaves some 1e-16 of a zero eigenvalue
FAR = 1e3  # rad or m: a limit beyond it is a placeholder such as 1e16
NO_INERTIA = 1e-12  # kg m^2 (kg for prismatic joints), far below a watch's hand


def check_complete(model: pin.Model, urdf: Urdf) -> None:
    """Compare joints and total mass with the text: a second look at what the first door let through.

    Raises
    ------
    ModelError
        If Pinocchio lost or added a joint or a mass.
    """
    names = list(model.names)[1:]
    if sorted(names) != sorted(urdf.moving) or model.nv != len(names):
        raise ModelError(f"{urdf.text.path}: Pinocchio reads the joints {names}, the text has {list(urdf.moving)}")
    masses = [vector(link.find("inertial/mass"), "value", (0.0,))[0] for link in urdf.links.values()]
    read = sum(inertia.mass for inertia in model.inertias)
    if not np.isclose(read, sum(masses), rtol=1e-9, atol=0.0):  # rounding of a sum of at most 200 terms
        raise ModelError(f"{urdf.text.path}: Pinocchio reads {read:g} kg, the text has {sum(masses):g} kg")


def check_inertia(model: pin.Model, armature: Array, path: object) -> tuple[str, ...]:
    """Names of joints that move no inertia (20 seeded configurations); the others' must be positive definite.

    Parameters
    ----------
    model : pinocchio.Model
        Without armature.
    armature : ndarray, shape (nv,)
        Rotor inertia at the joint in Pinocchio's order, 0 where unknown.
    path : object
        File named in the message.

    Raises
    ------
    ModelError
        If the joint-space inertia, rotors included, is not positive definite: no acceleration belongs to a
        torque then.
    """
    data = model.createData()
    inertias = np.array([np.array(pin.crba(model, data, q)) for q in _configurations(model)])
    upper = np.triu(inertias)  # crba fills the upper triangle alone
    inertias = upper + np.triu(upper, 1).transpose(0, 2, 1)
    present = ~(np.diagonal(inertias, axis1=1, axis2=2).max(axis=0) <= NO_INERTIA)
    inertias = (inertias + np.diag(armature))[:, present][:, :, present]
    diagonals = np.abs(np.diagonal(inertias, axis1=1, axis2=2))
    scales = np.sqrt(np.maximum(diagonals, NO_INERTIA))  # so that kg m^2 and kg compare
    lowest = np.linalg.eigvalsh(inertias / (scales[:, :, None] * scales[:, None, :]))[:, :1]
    if not (lowest > SINGULAR).all():
        raise ModelError(
            f"{path}: the joint-space inertia is not positive definite: masses and inertias are not those of bodies"
        )
    joints = zip(list(model.joints)[1:], list(model.names)[1:], strict=True)  # the first is the world
    return tuple(name for joint, name in joints if not present[joint.idx_v])


def massless_notes(model: pin.Model, urdf: Urdf) -> Iterator[str]:
    """Note each moving joint whose own body (with all that is fixed to it) has neither mass nor inertia."""
    for name in urdf.moving:
        body = model.inertias[model.getJointId(name)]
        if body.mass == 0 and not body.inertia.any():
            yield f"link {urdf.joints[name].child!r}: moves, but the URDF has no inertia for it; massless"


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
