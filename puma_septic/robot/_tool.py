"""Which frame of a robot is its tool, where nobody says."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from puma_septic.robot.urdf_checks import Urdf

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


def chosen_tool(urdf: Urdf) -> tuple[str, str]:
    """The frame that is taken for the tool, and a note of why and what else there is.

    A frame whose name says so: tool0, tcp, end effector, tool, flange, in this order, far out on the arm; else the end
    of the longest chain, fingers left out; among equals not one behind a sliding or locked joint.
    """
    lengths = {link: _length(urdf, link) for link in urdf.links}
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
    chosen = max(candidates, key=lambda link: (not _is_doubtful(urdf, link), lengths[link], candidates.index(link)))
    others = [link for link in candidates if link != chosen]
    as_good = f" (as good: {', '.join(others)})" if others else ""
    return chosen, f"tool frame {chosen!r}: {why}{as_good}; tool=... names another"


def _ends(urdf: Urdf) -> list[str]:
    parents = {joint.parent for joint in urdf.joints.values()}
    return [link for link in urdf.links if link not in parents]


def _length(urdf: Urdf, link: str) -> tuple[int, int]:
    """Moving joints, and all joints, from the base to a link."""
    carriers = urdf.carriers(link)
    return sum(urdf.joints[name].kind != "fixed" for name in carriers), len(carriers)


def _is_finger(urdf: Urdf, link: str) -> bool:
    return _without_fingers(urdf, link) != link


def _without_fingers(urdf: Urdf, link: str) -> str:
    """The link that carries the fingers which a link is part of; the link itself where it is part of none."""
    masters = {mimic.master for mimic in urdf.mimics.values()}
    above = urdf.above
    palm, place = link, link
    while place in above:
        joint = above[place]
        is_coupled = joint.name in urdf.mimics or joint.name in masters
        named = _FINGER.search(f"{joint.name} {joint.child}") or _GRIPS.search(joint.name)
        moves_finger = joint.element.get("type") != "fixed" and named
        if moves_finger or (is_coupled and _is_at_the_end(urdf, joint.child, above)):
            palm = joint.parent
        place = joint.parent
    return palm


def _is_at_the_end(urdf: Urdf, link: str, above: Mapping[str, object]) -> bool:
    """Whether nothing that moves on its own hangs on a link: of a gripper, not of an arm with a parallelogram."""
    return not any(link in _path(urdf, urdf.joints[name].parent) for name in urdf.moving if above)


def _path(urdf: Urdf, link: str) -> list[str]:
    return [link, *(urdf.joints[name].parent for name in urdf.carriers(link))]


def _is_doubtful(urdf: Urdf, link: str) -> bool:
    """Whether the last joint that could move it slides or is locked."""
    movable = [urdf.joints[name] for name in urdf.carriers(link) if urdf.joints[name].element.get("type") != "fixed"]
    return bool(movable) and (movable[0].kind == "fixed" or movable[0].kind == "prismatic")
