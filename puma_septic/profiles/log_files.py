"""CSV files of joint motions."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from typing import final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.validation import Array, checked_number, read_only

__all__ = ["JointLog", "read_csv_trajectory"]


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
    """

    t: Array
    q: Array
    joint_names: tuple[str, ...]


def read_csv_trajectory(path: str | PathLike[str], *, max_gap: float | None = None) -> JointLog:
    r"""Read samples of a motion from a CSV file: a header ``t, <joint>, ...``, then one row for each instant.

    Times in s, positions in rad (m for prismatic joints), decimal points, commas between the cells.

    Parameters
    ----------
    path : path_like
    max_gap : float, optional
        Longest step of time that is still taken for sampling, s; any is where it is not given.

    Raises
    ------
    InputError
        For a file that cannot be read, a missing or ambiguous header, rows that are short, long or empty,
        cells that are empty or not finite numbers, times that repeat or go back, steps of time longer than
        `max_gap`, and fewer than two rows. The message names file, row (as an editor counts lines) and
        column.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from puma_septic.profiles.log_files import read_csv_trajectory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("t,waist,elbow\n0.0,1.0,2.0\n0.5,1.5,2.5\n")
    ...     log = read_csv_trajectory(path)
    >>> log.joint_names, log.q.tolist()
    (('waist', 'elbow'), [[1.0, 2.0], [1.5, 2.5]])
    """
    rows = _csv_rows(path)
    if not rows:
        raise InputError(f"{path}: the file is empty; a header t, <joint>, ... and at least two rows are needed")
    header = [cell.strip() for cell in rows[0][1]]
    _check_header(path, header)
    if len(rows) < 3:
        raise InputError(f"{path}: {len(rows) - 1} rows of samples; at least two are needed")
    values = np.array([_numbers(f"{path}, row {line}", header, cells) for line, cells in rows[1:]])
    steps = np.diff(values[:, 0])
    for k in np.flatnonzero(~(steps > 0)):
        raise InputError(
            f"{path}, row {rows[k + 2][0]}, column 't': {values[k + 1, 0]:g} s does not come after"
            f" {values[k, 0]:g} s in row {rows[k + 1][0]}; times must increase strictly"
        )
    longest = np.inf if max_gap is None else checked_number("max_gap", max_gap, unit="s", above=0.0)
    for k in np.flatnonzero(steps > longest):
        raise InputError(
            f"{path}, row {rows[k + 2][0]}, column 't': a gap of {steps[k]:g} s since row {rows[k + 1][0]} is longer"
            f" than max_gap = {longest:g} s"
        )
    return JointLog(t=read_only(values[:, 0]), q=read_only(values[:, 1:]), joint_names=tuple(header[1:]))


def _csv_rows(path: str | PathLike[str]) -> list[tuple[int, list[str]]]:
    """Line number and cells of each row, without empty lines at the end."""
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            rows = [(reader.line_num, cells) for cells in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read as a CSV file: {error}") from error
    while rows and not any(cell.strip() for cell in rows[-1][1]):
        rows.pop()
    return rows


def _check_header(path: str | PathLike[str], header: Sequence[str]) -> None:
    """The first column is t, the others are distinct names."""
    if header[:1] != ["t"] or len(header) < 2:
        raise InputError(f"{path}, row 1: the header must be t, <joint>, ..., but is {', '.join(header)!r}")
    for k, name in enumerate(header):
        if not name or name in header[:k]:
            problem = "is used twice" if name else "is empty"
            raise InputError(f"{path}, row 1, column {k + 1}: the name {name!r} {problem}; each joint needs its own")


def _numbers(where: str, header: Sequence[str], cells: Sequence[str]) -> list[float]:
    """The cells of one row as finite numbers."""
    if not any(cell.strip() for cell in cells):
        raise InputError(f"{where} is empty")
    if len(cells) != len(header):
        raise InputError(f"{where} has {len(cells)} cells, the header {len(header)}")
    numbers = []
    for name, cell in zip(header, cells, strict=True):
        # float() would take 1_000 for a number.
        text = cell.strip()
        try:
            number = float(text) if "_" not in text else math.nan
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            problem = f"{text!r} is not a finite number" if text else "the value is missing"
            raise InputError(f"{where}, column {name!r}: {problem}")
        numbers.append(number)
    return numbers
