"""Where the JointTrajectory lies in the messages that carry one: plans of MoveIt, goals of actions.

Messages: trajectory_msgs/JointTrajectory; moveit_msgs/RobotTrajectory, DisplayTrajectory, MotionPlanResponse,
GetMotionPlan's response, ExecuteTrajectory's goal; control_msgs/FollowJointTrajectory's goal (ROS 1 and 2);
moveit_task_constructor_msgs/Solution.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, final

from puma_septic.ros._faults import Fault

__all__ = ["Found", "found_messages"]

# Fields that lead to a JointTrajectory.
_INTO: Final = (
    "goal", "request", "motion_plan_response", "planned_trajectory", "trajectory", "joint_trajectory",
    "sub_trajectory", "solution",
)  # fmt: skip
# Fields with the state that the motion starts from (moveit_msgs/RobotState).
_START: Final = ("trajectory_start", "start_state")
# Fields that move a floating base or the like.
_MULTI_DOF: Final = ("multi_dof_joint_trajectory", "multi_dof_trajectory")
# Fields beside them that say nothing about the motion of the joints.
_BESIDE: Final = (
    "header", "model_id", "goal_id", "group_name", "planning_time", "error_code", "controller_names", "path_tolerance",
    "component_path_tolerance", "goal_tolerance", "component_goal_tolerance", "goal_time_tolerance", "planner_id",
    "start_scene", "scene_diff", "info", "execution_info", "task_id", "sub_solution",
)  # fmt: skip


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Found:
    """A JointTrajectory as plain values.

    Attributes
    ----------
    where : str
        Its path in the document, empty where the document itself is it.
    message : Mapping
    start : Mapping or None
        The RobotState that the plan starts from, where the message around it has one.
    """

    where: str
    message: Mapping[str, Any]
    start: Mapping[str, Any] | None = None


def found_messages(document: object, faults: list[Fault]) -> list[Found]:
    """Every JointTrajectory in a document, in its order; what does not fit is added to `faults`."""
    return list(_walk(document, "", None, faults))


def _walk(node: object, where: str, start: Mapping[str, Any] | None, faults: list[Fault]) -> Iterator[Found]:
    if isinstance(node, list):
        for k, one in enumerate(node):
            # Only the first part of a plan starts where the plan does.
            yield from _walk(one, f"{where}[{k}]", start if k == 0 else None, faults)
    elif not isinstance(node, Mapping):
        faults.append(Fault(code="no_trajectory", message=f"{where or 'the document'} is no message but {node!r:.60}"))
    elif "joint_names" in node or "points" in node:
        yield Found(where=where, message=node, start=start)
    else:
        yield from _inside(node, where, start, faults)


def _inside(
    node: Mapping[str, Any], where: str, start: Mapping[str, Any] | None, faults: list[Fault]
) -> Iterator[Found]:
    """Go on into the one field that leads to a trajectory."""
    place = f"{where}." if where else ""
    into = [key for key in _INTO if key in node]
    known = {*_INTO, *_START, *_MULTI_DOF, *_BESIDE}
    if not into:
        keys = ", ".join(map(str, list(node)[:8])) or "nothing"
        faults.append(
            Fault(
                code="no_trajectory",
                message=f"no JointTrajectory (joint_names, points) in {where or 'the document'}, which has {keys}",
            )
        )
        return
    faults += [
        Fault(code="unknown_key", message=f"{place}{key} is no field of a message around a JointTrajectory")
        for key in node
        if key not in known
    ]
    for key in _MULTI_DOF:
        if isinstance(node.get(key), Mapping) and node[key].get("points"):
            text = f"{place}{key} moves joints of several degrees of freedom, which are not assessed"
            faults.append(Fault(code="unsupported", message=text))
    for key in _START:
        if isinstance(node.get(key), Mapping):
            start = node[key]
    for key in into:
        yield from _walk(node[key], place + key, start, faults)
