"""CSV files of joint motions, as loggers write them."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Final, Literal, NamedTuple, NoReturn, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import InputError, readable
from puma_septic.files import read_text
from puma_septic.logs._clock import even_stamps, exact_stamps, near_origin
from puma_septic.logs._columns import Layout, is_unit, laid_out
from puma_septic.robot import Robot
from puma_septic.validation import (
    LARGEST,
    Array,
    checked_choice,
    checked_kind,
    checked_number,
    checked_texts,
    read_only,
)

__all__ = ["JointLog", "read_csv_trajectory", "read_log"]

# 200,000 rows of six joints, at 1 kHz more than three minutes.
_MAX_BYTES: Final = 16_000_000
# s between samples: far below what any clock tells.
_SHORTEST: Final = 1e-12
_COMMENTS: Final = ("#", "%", "//")
_NAMES: Final = {";": "';'", "\t": "tabs", " ": "blanks"}


class _Row(NamedTuple):
    """A row as an editor counts it, and its cells."""

    line: int
    cells: list[str]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class _Cells:
    """A file's header, the units below it (empty where there are none), its rows, and what was decided."""

    header: _Row
    units: list[str]
    rows: list[_Row]
    notes: tuple[str, ...]


def _read_cells(path: str | PathLike[str]) -> _Cells:
    """Split a file into cells.

    Raises
    ------
    InputError
        For a file that cannot be read, or has no header.
    """
    lines = [readable(line) for line in read_text(path, what="CSV file", at_most=_MAX_BYTES).splitlines()]
    comments = sum(line.lstrip().startswith(_COMMENTS) for line in lines)
    plain = [line for line in lines if line.strip() and not line.lstrip().startswith(_COMMENTS)]
    separator = _separator(plain[0] if plain else "")
    rows = _rows(path, lines, separator)
    if not rows:
        raise InputError(f"{path}: the file is empty; a header t, <joint>, ... and at least two rows are needed")
    comma = separator != "," and not any("." in cell for row in rows[1:] for cell in row.cells)
    comma = comma and any("," in cell for row in rows[1:] for cell in row.cells)
    if comma:
        rows[1:] = [_Row(row.line, [cell.replace(",", ".") for cell in row.cells]) for row in rows[1:]]
    rows = _without_empty_column(rows)
    has_units = len(rows) > 1 and all(is_unit(cell) or not cell.strip() for cell in rows[1].cells)
    return _Cells(
        header=_Row(rows[0].line, [cell.strip() for cell in rows[0].cells]),
        units=rows[1].cells if has_units else [],
        rows=rows[2:] if has_units else rows[1:],
        notes=_notes(separator, comma=comma, comments=comments, empty=_empty_inside(lines)),
    )


def _separator(header: str) -> str:
    return next((separator for separator in (";", "\t", ",") if separator in header), " ")


def _rows(path: str | PathLike[str], lines: Sequence[str], separator: str) -> list[_Row]:
    """Rows with something in them; comments count as lines."""

    def told() -> Iterator[str]:
        for line in lines:
            yield "" if line.lstrip().startswith(_COMMENTS) else line

    if separator == " ":
        return [_Row(k + 1, cells) for k, line in enumerate(told()) if (cells := line.split())]
    try:
        reader = csv.reader(told(), delimiter=separator, strict=True, skipinitialspace=True)
        return [_Row(reader.line_num, cells) for cells in reader if "".join(cells).strip()]
    except csv.Error as error:
        raise InputError(f"{path}: cannot be read as a CSV file: {error}") from error


def _without_empty_column(rows: list[_Row]) -> list[_Row]:
    """Rows without what a separator at the end of every line makes."""
    if len(rows) < 2 or any(row.cells[-1].strip() for row in rows[1:]):
        return rows
    width = len(rows[0].cells) - (not rows[0].cells[-1].strip())
    if any(len(row.cells) != width + 1 for row in rows[1:]):
        return rows
    return [_Row(row.line, row.cells[:width]) for row in rows]


def _empty_inside(lines: Sequence[str]) -> int:
    filled = [k for k, line in enumerate(lines) if line.strip()]
    return sum(not line.strip() for line in lines[: filled[-1]]) if filled else 0


def _notes(separator: str, *, comma: bool, comments: int, empty: int) -> tuple[str, ...]:
    def counted(count: int, what: str) -> Iterable[str]:
        return [f"{count} {what}{'s' if count > 1 else ''}"] if count else []

    parts = [
        *([f"separator {_NAMES[separator]}"] if separator != "," else []),
        *(["decimal comma"] if comma else []),
        *counted(comments, "comment line"),
        *counted(empty, "empty line"),
    ]
    return (", ".join(parts),) if parts else ()


Path = str | PathLike[str]

# Values of one stamp that differ by no more than this are one row, written twice.
_SAME: Final = 1e-12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointLog:
    """Samples of a joint motion.

    Attributes
    ----------
    t : ndarray, shape (n,)
        s, strictly increasing.
    q : ndarray, shape (n, n_joints)
        rad (m for prismatic joints).
    joint_names : tuple of str
    velocity, effort, current : ndarray, shape (n, n_joints), or None
        Where the file has columns of them: rad/s, N m (N), A; NaN for joints without.
    is_continuous : ndarray of bool, shape (n_joints,)
        Joints that turn without bounds, which may wrap; none where no robot is known.
    origin : str
        The first stamp as the file has it.
    units_stated : bool
        Whether the file or its reader has said in which units times and positions are.
    notes : tuple of str
        What was decided while reading.
    """

    t: Array
    q: Array
    joint_names: tuple[str, ...]
    velocity: Array | None = None
    effort: Array | None = None
    current: Array | None = None
    is_continuous: NDArray[np.bool_]
    origin: str = "0"
    units_stated: bool = False
    notes: tuple[str, ...] = ()


def read_log(
    path: Path,
    robot: Robot | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    units: Sequence[str] = (),
    repeated: Literal["refuse", "average"] = "refuse",
    max_gap: float | None = None,
) -> JointLog:
    r"""Read samples of a motion from a CSV file as loggers write it.

    A header names the columns: the time (``t``, ``time``, ``stamp``, ``timestamp``) and one for each joint, bare or
    with a word beside it (``elbow``, ``elbow_pos``, ``position elbow``); velocities, efforts and currents are read
    where they are named so (``elbow_vel``, ``elbow_torque``, ``elbow.current``). Units stand in brackets behind a name,
    in a row below the header, or are given; else they are s, rad and m. Commas, semicolons, tabs or blanks may separate
    the cells; decimal commas, comments (``#``, ``%``, ``//``), empty lines and a separator at the end of each line are
    read. Columns that nobody knows are ignored and listed in `notes`.

    Parameters
    ----------
    path : path_like
    robot : Robot, optional
        Whose joints are looked for, and put into its order; it also tells which of them are continuous.
    columns : mapping, optional
        Which column is what, from "time", "JOINT", "JOINT.velocity", "JOINT.effort" or "JOINT.current" to a column's
        name, with its unit in brackets where that is to be said: ``{"time": "stamp[ms]", "elbow": "q3[deg]"}``.
    units : sequence of str
        Of columns that have none of their own: s, ms, us, ns; rad, deg; m, mm.
    repeated : {"refuse", "average"}
        What becomes of rows with one stamp. Those that are equal are read once in any case.
    max_gap : float, optional
        Longest step of time that is still taken for sampling, s; any is where it is not given.

    Returns
    -------
    JointLog

    Raises
    ------
    InputError
        For a file that cannot be read, a missing or ambiguous header, rows that are short or long, cells that are empty
        or not finite numbers, times that repeat or go back, gaps, and fewer than two rows. The message names file, row
        (as an editor counts lines) and column.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from puma_septic.logs import read_log
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("# arm 3\nstamp [ms];elbow_deg;mode\n0;90,0;2\n10;91,5;2\n")
    ...     log = read_log(path, columns={"elbow": "elbow_deg[deg]"})
    >>> log.t.tolist(), log.q.round(4).tolist(), log.joint_names
    ([0.0, 0.01], [[1.5708], [1.597]], ('elbow',))
    >>> log.notes
    ("separator ';', decimal comma, 1 comment line", "columns not read: 'mode'")
    """
    checked_choice("repeated", repeated, ("refuse", "average"))
    if robot is not None:
        checked_kind("robot", robot, Robot)
    units = checked_texts("units", units)
    cells = _read_cells(path)
    layout = laid_out(
        f"{path}, row {cells.header.line}",
        cells.header.cells,
        joints=None if robot is None else robot.joint_names,
        chosen=columns or {},
        unit_row=cells.units,
        units=units,
    )
    if len(cells.rows) < 2:
        raise InputError(f"{path}: {len(cells.rows)} rows of samples; at least two are needed")
    values = _numbers(path, cells.header.cells, cells.rows, layout)
    clock = layout.of("time")[""]
    stamps = [row.cells[clock.index].strip() for row in cells.rows]
    t, first, digit = exact_stamps(stamps, clock.factor)
    lines = np.array([row.line for row in cells.rows])
    positions = [column.quantity == "position" for column in layout.columns]
    t, values, lines, merged = _without_repeats(t, values, lines, positions, average=repeated == "average")
    _check_times(path, t, lines, max_gap, clock.name)
    even = even_stamps(t, max(digit, 2 * float(np.spacing(abs(float(first)))) * clock.factor))
    notes = [*cells.notes, *merged]
    if even is not t:
        notes.append(f"stamps are even but for their last digit: taken every {np.diff(even).min():.9g} s")
    if layout.ignored:
        notes.append(f"columns not read: {', '.join(map(repr, layout.ignored))}")
    start = near_origin(float(first) * clock.factor, float(t[-1]))
    return _joined(layout, robot, even + start, values, str(first), notes)


def read_csv_trajectory(path: Path, *, max_gap: float | None = None) -> JointLog:
    """`read_log` of a file whose columns need no explanation.

    Returns
    -------
    JointLog
    """
    return read_log(path, max_gap=max_gap)


def _numbers(path: Path, header: Sequence[str], rows: Sequence[_Row], layout: Layout) -> Array:
    """The wanted columns in SI units, shape (n, number of columns), in the order of the layout."""
    wanted = [column.index for column in layout.columns]
    for row in rows:
        if len(row.cells) != len(header):
            raise InputError(f"{path}, row {row.line} has {len(row.cells)} cells, the header {len(header)}")
    texts = [[row.cells[k].strip() for k in wanted] for row in rows]
    try:
        values = np.array([[float(text) for text in row] for row in texts])
        good = (np.abs(values) <= LARGEST).all() and all(_is_plain("".join(row)) for row in texts)
    except ValueError:
        good = False
    if not good:
        _refuse_cell(path, rows, layout)
    return np.asarray(values * [column.factor for column in layout.columns])


def _is_plain(text: str) -> bool:
    """Whether `float` reads what is written: it would take 1_000, and the digits of any script, for numbers."""
    return text.isascii() and "_" not in text


def _refuse_cell(path: Path, rows: Sequence[_Row], layout: Layout) -> NoReturn:
    """Name the first cell that is no number."""
    cells = ((row.line, column.name, row.cells[column.index].strip()) for row in rows for column in layout.columns)
    line, name, text = next(cell for cell in cells if not _is_number(cell[-1]))
    problem = f"{text!r} is not a finite number up to {LARGEST:g}" if text else "the value is missing"
    raise InputError(f"{path}, row {line}, column {name!r}: {problem}")


def _is_number(text: str) -> bool:
    try:
        return _is_plain(text) and abs(float(text)) <= LARGEST
    except ValueError:
        return False


def _without_repeats(
    t: Array, values: Array, lines: NDArray[np.int64], positions: Sequence[bool], *, average: bool
) -> tuple[Array, Array, NDArray[np.int64], list[str]]:
    """One row for each stamp: of rows that are equal, or of any by their mean where that is wanted."""
    same = np.diff(t) == 0
    if not same.any():
        return t, values, lines, []
    if not average:
        # Other signals may step there.
        q = values[:, positions]
        same &= (np.abs(np.diff(q, axis=0)) <= _SAME * np.abs(q).max(axis=0)).all(axis=1)
        if not same.any():
            return t, values, lines, []
    starts = np.concatenate([[0], np.flatnonzero(~same) + 1])
    counts = np.diff(np.append(starts, len(t)))
    means = np.add.reduceat(values, starts, axis=0) / counts[:, None]
    note = f"{len(t) - len(starts)} rows repeat a stamp: {'averaged' if average else 'equal, read once'}"
    return t[starts], means, lines[starts], [note]


def _check_times(path: Path, t: Array, lines: NDArray[np.int64], max_gap: float | None, name: str) -> None:
    steps = np.diff(t)
    for k in np.flatnonzero(~(steps >= _SHORTEST))[:1]:
        remedy = "; repeated stamps can be averaged" if steps[k] == 0 else ""
        raise InputError(
            f"{path}, row {lines[k + 1]}, column {name!r}: {t[k + 1]:g} s does not come after {t[k]:g} s in row"
            f" {lines[k]}; times must increase strictly{remedy}"
        )
    longest = math.inf if max_gap is None else checked_number("max_gap", max_gap, unit="s", above=0.0)
    for k in np.flatnonzero(steps > longest)[:1]:
        raise InputError(
            f"{path}, row {lines[k + 1]}, column {name!r}: a gap of {steps[k]:g} s since row {lines[k]} is longer"
            f" than max_gap = {longest:g} s"
        )


def _joined(
    layout: Layout, robot: Robot | None, t: Array, values: Array, origin: str, notes: Sequence[str]
) -> JointLog:
    """The columns in the robot's order, or the file's."""
    joints = layout.joints if robot is None else robot.joint_names
    places = {(column.quantity, column.joint): k for k, column in enumerate(layout.columns)}
    _check_units(layout, robot)

    def signal(quantity: str) -> Array | None:
        if not layout.of(quantity):
            return None
        padded = np.column_stack([values, np.full(len(t), np.nan)])
        return read_only(padded[:, [places.get((quantity, joint), -1) for joint in joints]])

    position = signal("position")
    assert position is not None  # the layout has one for each joint
    return JointLog(
        t=read_only(t),
        q=position,
        joint_names=tuple(joints),
        velocity=signal("velocity"),
        effort=signal("effort"),
        current=signal("current"),
        is_continuous=np.zeros(len(joints), np.bool_) if robot is None else robot.is_continuous,
        origin=origin,
        units_stated=all(column.unit for column in layout.columns if column.quantity in ("time", "position")),
        notes=tuple(notes),
    )


def _check_units(layout: Layout, robot: Robot | None) -> None:
    """Angles for joints that turn, lengths for those that slide."""
    for column in layout.columns:
        if robot is None or not column.joint or not column.unit or column.quantity not in ("position", "velocity"):
            continue
        slides = bool(robot.is_prismatic[robot.joint_names.index(column.joint)])
        if slides != column.unit.startswith("m"):
            valid = "m or mm" if slides else "rad or deg"
            how = "slides" if slides else "turns"
            raise InputError(
                f"column {column.name!r}: joint {column.joint!r} {how}; its unit is {valid}, not {column.unit!r}"
            )
