"""Which frame of a robot is its tool, where nobody says."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Final

from puma_septic.robot._urdf_checks import Urdf

__all__ = ["chosen_tool"]

# Names that public robots give to the place where a tool is mounted or works, the surest first.
_NAMES: Final = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"(^|[_/-])tool0$",
        r"tcp",
        r"end_?effector|(^|[_/-])eef?([_-](link|frame))?$",
        r"(^|[_/-])tool([_-]?(link|frame|point|center_point|tip))?$|grasp_?(frame|link|target)|(^|[_/-])ee_",
        r"flange",
    )
)
_FINGER: Final = re.compile(r"finger|thumb|knuckle|jaw|claw", re.IGNORECASE)
_GRIPS: Final = re.compile(r"gripper", re.IGNORECASE)  # of a joint; of a link it may be the palm
# A named frame counts if at least this part of the longest chain's joints carries it: not the camera on the base.
_FAR_OUT: Final = 0.5


def chosen_tool(urdf: Urdf, locked: Collection[str] = ()) -> tuple[str, str]:
    """The frame that is taken for the tool, and a note of why and what else there is.

    A frame whose name says so: tool0, tcp, end effector, tool, flange, in this order, far out on the arm; else the end
    of the longest chain, fingers left out; among equals not one behind a sliding or locked joint.
    """
    lengths = {link: _length(urdf, link, locked) for link in urdf.links}
    most = max(moving for moving, _ in lengths.values())
    named = [
        (rank, link)
        for link in urdf.links
        for rank in [next((k for k, name in enumerate(_NAMES) if name.search(link)), None)]
        if rank is not None and lengths[link][0] >= _FAR_OUT * most and not _is_finger(urdf, link)
    ]
    if named:
        best = min(rank for rank, _ in named)
        candidates, why = [link for rank, link in named if rank == best], "named like one"
    else:
        ends = dict.fromkeys(_without_fingers(urdf, link) for link in _ends(urdf))
        longest = max(lengths[link] for link in ends)
        candidates, why = [link for link in ends if lengths[link] == longest], "the last link of the longest chain"
    chosen = max(
        candidates, key=lambda link: (not _is_doubtful(urdf, link, locked), lengths[link], candidates.index(link))
    )
    others = [link for link in candidates if link != chosen]
    as_good = f" (as good: {', '.join(others)})" if others else ""
    return chosen, f"tool frame {chosen!r}: {why}{as_good}; tool=... names another"


def _ends(urdf: Urdf) -> list[str]:
    parents = {joint.parent for joint in urdf.joints.values()}
    return [link for link in urdf.links if link not in parents]


def _length(urdf: Urdf, link: str, locked: Collection[str]) -> tuple[int, int]:
    """Joints with a motor of their own, and all joints, from the base to a link."""
    carriers, moving = urdf.carriers(link), set(urdf.moving) - set(locked)
    return sum(name in moving for name in carriers), len(carriers)


def _is_finger(urdf: Urdf, link: str) -> bool:
    return _without_fingers(urdf, link) != link


def _without_fingers(urdf: Urdf, link: str) -> str:
    """The link that carries the fingers which a link is part of; the link itself where it is part of none."""
    masters = {mimic.master for mimic in urdf.mimics.values()}
    above = urdf.above
    palm, place = link, link
    while place in above:
        joint = above[place]
        master = urdf.mimics[joint.name].master if joint.name in urdf.mimics else joint.name
        named = _FINGER.search(f"{joint.name} {joint.child}") or _GRIPS.search(joint.name)
        moves_finger = joint.kind != "fixed" and named
        if moves_finger or (master in masters and _is_gripper(urdf, master) and _is_at_the_end(urdf, joint.child)):
            palm = joint.parent
        place = joint.parent
    return palm


def _is_gripper(urdf: Urdf, master: str) -> bool:
    """Whether all that follows a joint hangs on the link that it hangs on, as levers of a parallelogram do not."""
    followers = [name for name, mimic in urdf.mimics.items() if mimic.master == master]
    return all(urdf.joints[master].parent in _path(urdf, urdf.joints[name].parent) for name in followers)


def _is_at_the_end(urdf: Urdf, link: str) -> bool:
    """Whether nothing that moves on its own hangs on a link."""
    return not any(link in _path(urdf, urdf.joints[name].parent) for name in urdf.moving)


def _path(urdf: Urdf, link: str) -> list[str]:
    return [link, *(urdf.joints[name].parent for name in urdf.carriers(link))]


def _is_doubtful(urdf: Urdf, link: str, locked: Collection[str]) -> bool:
    """Whether the last joint that could move it slides or is locked."""
    movable = [urdf.joints[name] for name in urdf.carriers(link) if urdf.joints[name].kind != "fixed"]
    return bool(movable) and (movable[0].name in locked or movable[0].kind == "prismatic")
