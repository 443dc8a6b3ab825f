"""Recordings, rosbag2 folders and MCAP files, by the package rosbags; loaded only where one is read."""

from __future__ import annotations

import hashlib
import stat
import struct
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final, final

import apsw
import numpy as np
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag2 import ReaderError
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_typestore
from rosbags.typesys.store import Typestore

from puma_septic.errors import InputError
from puma_septic.files import kind_of, sha256_of, why

if sys.version_info >= (3, 14):  # as rosbags does
    from compression import zstd
else:
    from backports import zstd

__all__ = ["JOINT_STATE", "TRAJECTORY_TYPES", "Recording", "read_recording", "recorded_topics"]

JOINT_STATE: Final = "sensor_msgs/msg/JointState"
TRAJECTORY_TYPES: Final = (
    "trajectory_msgs/msg/JointTrajectory",
    "moveit_msgs/msg/RobotTrajectory",
    "moveit_msgs/msg/DisplayTrajectory",
)
_MOST_BYTES: Final = 4_000_000_000
_MOST_DESCRIPTION: Final = 1_000_000
_MOST_MESSAGES: Final = 2_000_000
# What rosbags and what it stands on raise for a damaged recording.
_FOREIGN: Final = (
    AnyReaderError, ReaderError, SerdeError, TypesysError, apsw.Error, zstd.ZstdError, struct.error, OSError,
    ValueError, KeyError, TypeError, OverflowError, MemoryError, RuntimeError,
)  # fmt: skip


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Recording:
    """The messages of one topic.

    Attributes
    ----------
    topic, kind : str
        Its name and message type.
    messages : tuple of dict
        As plain values.
    nanoseconds : ndarray of int, shape (n,)
        When each was recorded.
    sha256 : str
        Of the recording; of a folder, of the lines ``SHA-256 name`` of its files, by name.
    """

    topic: str
    kind: str
    messages: tuple[dict[str, Any], ...]
    nanoseconds: NDArray[np.int64]
    sha256: str


def recorded_topics(path: Path) -> dict[str, str]:
    """Message type of each topic of a recording."""
    with _opened(path) as reader:
        return {connection.topic: connection.msgtype for connection in reader.connections}


def read_recording(path: Path, kinds: tuple[str, ...], topic: str | None) -> Recording:
    """All messages of the topic, or of the only one with a message type out of `kinds`.

    Raises
    ------
    InputError
        For a recording that is damaged or too large, and where not exactly one topic fits.
    """
    digest = _digest(path)
    with _opened(path) as reader:
        topics = {connection.topic: connection.msgtype for connection in reader.connections}
        chosen = _chosen(path, topics, kinds, topic)
        connections = [connection for connection in reader.connections if connection.topic == chosen]
        count = sum(connection.msgcount for connection in connections)
        if count > _MOST_MESSAGES:
            raise InputError(f"{path}: {count:,} messages on {chosen}; at most {_MOST_MESSAGES:,} are read")
        messages, times = [], []
        for connection, time, data in reader.messages(connections=connections):
            messages.append(_plain(reader.deserialize(data, connection.msgtype)))
            times.append(time)
    return Recording(
        topic=chosen,
        kind=topics[chosen],
        messages=tuple(messages),
        nanoseconds=np.array(times, dtype=np.int64),
        sha256=digest,
    )


@contextmanager
def _opened(path: Path) -> Iterator[AnyReader]:
    _files(path)
    try:
        with AnyReader([path], default_typestore=_types()) as reader:
            yield reader
    except InputError:
        raise
    except _FOREIGN as error:
        raise InputError(f"{path}: cannot be read as a recording: {type(error).__name__}: {error}") from error


@cache
def _types() -> Typestore:
    """The messages of Humble: recordings of it and before do not hold their definitions."""
    return get_typestore(Stores.ROS2_HUMBLE)


def _files(path: Path) -> list[Path]:
    """The files of a recording, in order of their names; none larger than it may be."""
    try:
        kind = kind_of(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: this recording cannot be read: {why(error)}") from error
    if not kind:
        raise InputError(f"{path}: this recording does not exist")
    files = sorted(one for one in path.iterdir() if one.is_file()) if stat.S_ISDIR(kind) else [path]
    for one in files:
        # rosbags reads the description with a YAML parser that takes 7 s for a megabyte.
        most = _MOST_DESCRIPTION if one.name == "metadata.yaml" else _MOST_BYTES
        if one.stat().st_size > most:
            raise InputError(f"{one}: larger than the {most:,} bytes that it may have")
    return files


def _digest(path: Path) -> str:
    """SHA-256 of a file; of a folder, of the digests and names of its files."""
    files = _files(path)
    if not path.is_dir():
        return sha256_of(path)
    lines = "".join(f"{sha256_of(one)} {one.name}\n" for one in files)
    return hashlib.sha256(lines.encode()).hexdigest()


def _chosen(path: Path, topics: Mapping[str, str], kinds: tuple[str, ...], topic: str | None) -> str:
    told = ", ".join(f"{name} ({kind})" for name, kind in topics.items()) or "none"
    if topic is not None:
        if topic not in topics:
            raise InputError(f"{path}: no topic {topic!r}; it has {told}")
        if topics[topic] not in kinds:
            raise InputError(f"{path}: topic {topic!r} is of {topics[topic]}; needed: {', '.join(kinds)}")
        return topic
    fitting = [name for name, kind in topics.items() if kind in kinds]
    if len(fitting) != 1:
        which = f"{len(fitting)} topics have" if fitting else "no topic has"
        raise InputError(f"{path}: {which} messages of {' or '.join(kinds)}; name one of its topics: {told}")
    return fitting[0]


def _plain(value: Any) -> Any:
    """A message of rosbags as dicts, lists and numbers."""
    if is_dataclass(value):
        return {
            field.name: _plain(getattr(value, field.name)) for field in fields(value) if field.name != "__msgtype__"
        }
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_plain(one) for one in value] if isinstance(value, list) else value
