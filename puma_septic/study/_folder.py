"""The folder of a study: its definition, one Parquet file for each chunk, a lock.

A chunk is there whole or not at all, and its name ends in the CRC-32 of its bytes: Parquet's own checksums leave out
the footer, where a flipped bit renames a column or moves the bounds by which a query passes over rows.
"""

from __future__ import annotations

import fcntl
import json
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final, final

from puma_septic.errors import InputError
from puma_septic.files import why
from puma_septic.outputs import write_file

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError as error:
    raise InputError(
        "a study needs the packages pyarrow and duckdb: python -m pip install 'puma-septic[study]'"
    ) from error

from puma_septic.study._definition import Study

__all__ = ["StudyFolder", "table_from_bytes", "table_of", "table_to_bytes"]

_DEFINITION: Final = "study.json"
_LOCK: Final = "lock"
_CHUNKS: Final = "chunks"
_CHUNK: Final = re.compile(r"(?P<k>\d{8})-(?P<crc>[0-9a-f]{8})\.parquet")


def table_of(columns: dict[str, Any]) -> pa.Table:
    """Columns as a table: what is not known (NaN) is null, text as a dictionary."""
    arrays = {}
    for name, values in columns.items():
        if name == "feasible":
            arrays[name] = pa.array(values.astype(bool), mask=columns["error"] != "")
        elif values.dtype.kind in "OU":
            arrays[name] = pa.array(values.tolist(), type=pa.string()).dictionary_encode()
        else:
            arrays[name] = pa.array(values, from_pandas=True)
    return pa.table(arrays)


def table_to_bytes(table: pa.Table) -> bytes:
    """A table for another process."""
    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, table.schema) as stream:
        stream.write_table(table)
    return bytes(sink.getvalue())


def table_from_bytes(data: bytes) -> pa.Table:
    """The table that `table_to_bytes` wrote."""
    return pa.ipc.open_stream(pa.BufferReader(data)).read_all()


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StudyFolder:
    """Where a study stands."""

    path: Path

    @property
    def chunks(self) -> Path:
        """The folder of its Parquet files."""
        return self.path / _CHUNKS

    def definition(self) -> dict[str, Any]:
        """What the study was, as `Study.document` gave it.

        Raises
        ------
        InputError
            Where no study stands.
        """
        try:
            document: dict[str, Any] = json.loads((self.path / _DEFINITION).read_text(encoding="utf-8"))
        except FileNotFoundError as error:
            raise InputError(f"{self.path}: no study is there (no {_DEFINITION})") from error
        except (OSError, ValueError) as error:
            raise InputError(f"{self.path / _DEFINITION}: cannot be read: {error}") from error
        return document

    @contextmanager
    def opened(self, study: Study) -> Iterator[None]:
        """Hold the folder for this study alone.

        Raises
        ------
        InputError
            Where another study stands, another run is at work, or nothing can be written.
        """
        try:
            self.chunks.mkdir(parents=True, exist_ok=True)
            with (self.path / _LOCK).open("a") as lock:
                _hold(lock, self.path)
                self._claim(study)
                yield
        except OSError as error:
            raise InputError(f"cannot write the study's folder {self.path}: {error.strerror or error}") from error

    def _claim(self, study: Study) -> None:
        file = self.path / _DEFINITION
        document = {**study.document(), "digest": study.digest}
        if not file.exists():
            if any(self.chunks.iterdir()):
                raise InputError(f"{self.path}: has chunks but no {_DEFINITION}; name another folder")
            # Replacing is a rename alone, which leaves no second name behind if it is killed.
            write_file(file, json.dumps(document, indent=2), overwrite=True)
        old = self.definition()
        if old.get("digest") != study.digest:
            changed = [key for key, value in document.items() if key != "digest" and old.get(key) != value]
            raise InputError(
                f"{self.path}: holds another study ({', '.join(changed) or 'drawn otherwise'} differ); name another"
                " folder, or take the old definition"
            )

    def finished(self) -> dict[int, Path]:
        """The files of the chunks that are there, in order.

        Raises
        ------
        InputError
            For one that is damaged, with its name.
        """
        found = {}
        for path in sorted(self.chunks.glob("*.parquet")):
            if name := _CHUNK.fullmatch(path.name):
                _check_chunk(path, name["crc"])
                found[int(name["k"])] = path
        return found

    def write(self, k: int, table: pa.Table) -> None:
        """Chunk k, whole or not at all."""
        sink = pa.BufferOutputStream()
        pq.write_table(table, sink, compression="zstd")
        data = sink.getvalue().to_pybytes()
        write_file(self.chunks / f"{k:08d}-{_crc(data)}.parquet", data, overwrite=True)


def _crc(data: bytes) -> str:
    return f"{zlib.crc32(data):08x}"


def _check_chunk(path: Path, crc: str) -> None:
    try:
        damage = "" if _crc(path.read_bytes()) == crc else "its bytes have another checksum than its name"
    except OSError as error:
        damage = why(error)
    if damage:
        raise InputError(
            f"{path}: this chunk is damaged ({damage}); delete it and run the study again: all others are kept"
        )


def _hold(lock: IO[str], path: Path) -> None:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise InputError(
            f"{path}: another run is at work on this study; wait for its end, or name another folder"
        ) from error
