"""Recordings, rosbag2 folders and MCAP files: trajectories and joint states. The library writes its own small ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.ros_bags import record, state_message, states, trajectory_message
from helpers.ros_messages import NAMES, small_move

import puma_septic as ps
from puma_septic.ros import (
    JointTrajectoryError,
    _bags,
    read_joint_state_log,
    read_joint_trajectories,
    recorded_topics,
)


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_recorded_trajectory_is_the_one_that_was_sent(puma: ps.Robot, tmp_path: Path, storage: str) -> None:
    move = small_move(puma)
    bag = record(tmp_path / "bag", storage, {"/arm/joint_trajectory": [(1, trajectory_message(move, [0.0, 2.0]))]})
    paths = [bag, *bag.glob("*.mcap")]
    digests = set()
    for path in paths:
        [planned] = read_joint_trajectories(path, puma)
        digests.add(planned.sha256)
        t = np.linspace(0, 2, 21)
        assert np.abs(planned.trajectory(t) - move(t)).max() < 1e-14
    assert len(digests) == len(paths)
    assert recorded_topics(bag) == {"/arm/joint_trajectory": "trajectory_msgs/msg/JointTrajectory"}


def test_every_message_of_a_topic_is_a_trajectory(
    puma: ps.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    move = small_move(puma)
    message = trajectory_message(move, [0.0, 2.0])
    bag = record(tmp_path / "bag", "mcap", {"/a": [(1, message), (2, message)], "/b": [(1, message)]})
    with pytest.raises(JointTrajectoryError, match=r"2 topics have messages of .*; name one of its topics: /a \("):
        read_joint_trajectories(bag, puma)
    assert len(read_joint_trajectories(bag, puma, topic="/a")) == 2
    assert len(read_joint_trajectories(bag, puma, topic="/b")) == 1
    with pytest.raises(JointTrajectoryError, match="no topic '/c'; it has /a"):
        read_joint_trajectories(bag, puma, topic="/c")
    with pytest.raises(
        ps.InputError, match="topic '/a' is of trajectory_msgs/msg/JointTrajectory; needed: sensor_msgs"
    ):
        read_joint_state_log(bag, puma, topic="/a")
    monkeypatch.setattr(_bags, "_MOST_MESSAGES", 1)
    with pytest.raises(JointTrajectoryError, match="2 messages on /a; at most 1 are read"):
        read_joint_trajectories(bag, puma, topic="/a")


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_joint_states_are_a_log(puma: ps.Robot, tmp_path: Path, storage: str) -> None:
    """Stamps since 1970, joints in another order, and a gripper that reports on the same topic."""
    move = small_move(puma)
    gripper = (10**9, state_message(("finger",), [0.02], 10**18 + 10**9))
    messages = sorted([*states(move, 50), gripper], key=lambda one: one[0])
    bag = record(tmp_path / "bag", storage, {"/joint_states": messages})
    log = read_joint_state_log(bag, puma)
    assert len(log.t) == 101
    assert log.t[[0, -1]].tolist() == [0.0, 2.0]
    assert np.abs(log.q - move(log.t)).max() < 1e-12
    assert log.notes == ("1 messages without all joints are left out",)
    fitted = ps.fit_trajectory(log.t, log.q, joint_names=puma.joint_names)
    # A quintic spline through samples 20 ms apart of a quintic from rest to rest.
    assert np.abs(fitted(log.t, 1) - move(log.t, 1)).max() < 1e-9


def test_joint_states_without_stamps_have_the_recorders_times(puma: ps.Robot, tmp_path: Path) -> None:
    messages = [(10**9 * k, state_message(NAMES, [0.1 * k] * 6, 0)) for k in range(1, 4)]
    log = read_joint_state_log(record(tmp_path / "bag", "mcap", {"/joint_states": messages}), puma)
    assert log.t.tolist() == [0.0, 1.0, 2.0]
    assert log.notes == ("messages without a stamp: the times are those of the recorder",)


def test_joint_states_that_are_no_log(puma: ps.Robot, tmp_path: Path) -> None:
    twice = [(k, state_message(NAMES, [0.0] * 6, 10**9)) for k in range(2)]
    with pytest.raises(ps.InputError, match="message 2 is stamped 0 s after the first, message 1 0 s; times must"):
        read_joint_state_log(record(tmp_path / "a", "mcap", {"/joint_states": twice}), puma)
    other = [(k, state_message(("finger",), [0.0], k)) for k in range(3)]
    with pytest.raises(ps.InputError, match="0 of 3 messages on /joint_states have all joints of robot 'puma560'"):
        read_joint_state_log(record(tmp_path / "b", "mcap", {"/joint_states": other}), puma)


def test_recordings_that_cannot_be_read(puma: ps.Robot, tmp_path: Path) -> None:
    with pytest.raises(JointTrajectoryError, match="this recording does not exist"):
        read_joint_trajectories(tmp_path / "none.mcap", puma)
    (tmp_path / "empty").mkdir()
    with pytest.raises(JointTrajectoryError, match="cannot be read as a recording"):
        read_joint_trajectories(tmp_path / "empty", puma)
    (tmp_path / "empty" / "metadata.yaml").write_text("#" * 1_000_001)
    with pytest.raises(JointTrajectoryError, match="larger than the 1,000,000 bytes that it may have"):
        read_joint_trajectories(tmp_path / "empty", puma)
    (tmp_path / "text.mcap").write_text("no recording")
    with pytest.raises(JointTrajectoryError, match="cannot be read as a recording"):
        read_joint_trajectories(tmp_path / "text.mcap", puma)
    (tmp_path / "a.yaml").write_text("a: 1")
    with pytest.raises(JointTrajectoryError, match="only bags have topics"):
        read_joint_trajectories(tmp_path / "a.yaml", puma, topic="/a")


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_damaged_recording_is_bad_input_never_a_crash(
    puma: ps.Robot, tmp_path: Path, rng: np.random.Generator, storage: str
) -> None:
    """40 recordings with bytes changed or cut off: read as they are, or refused."""
    bag = record(tmp_path / "bag", storage, {"/t": [(1, trajectory_message(small_move(puma), [0.0, 2.0]))]})
    [path] = [one for one in bag.iterdir() if one.name != "metadata.yaml"]
    data = path.read_bytes()
    refused = 0
    for k in range(40):
        damaged = bytearray(data)
        for _ in range(rng.integers(1, 4)):
            damaged[rng.integers(len(damaged))] = rng.integers(256)
        path.write_bytes(damaged[: rng.integers(len(damaged))] if k % 4 == 0 else damaged)
        try:
            read_joint_trajectories(bag, puma)
        except ps.InputError:
            refused += 1
    assert refused > 8
