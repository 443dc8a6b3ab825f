"""What is written is there whole or not at all, and replaces nothing unasked."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
import time
from pathlib import Path
from threading import Barrier, Thread
from typing import Any

import pytest

import puma_septic as ps
from puma_septic.outputs import file_names, new_folder, write_file

# Writes without end, until it is killed: a file in its own folder, or one in a folder that is to be made.
WRITER = """
import sys
from pathlib import Path
from puma_septic.outputs import new_folder, write_file
kind, place = sys.argv[1], Path(sys.argv[2])
print("ready", flush=True)
k = 0
while True:
    k += 1
    if kind == "file":
        write_file(place, 200_000 * "x", overwrite=True)
    else:
        with new_folder(place / str(k)) as folder:
            for name in "abc":
                (folder / name).write_text(50_000 * "x")
"""


def left_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


# ---- files


def test_a_file_is_not_replaced_unasked(tmp_path: Path) -> None:
    """`replay mytask.yaml --html mytask.yaml` put a page in place of the task."""
    target = write_file(tmp_path / "a.txt", "mine")
    with pytest.raises(ps.InputError, match=r"a\.txt exists; nothing is overwritten, name another file"):
        write_file(target, "theirs")
    assert target.read_text() == "mine"
    assert write_file(target, b"asked for", overwrite=True).read_bytes() == b"asked for"
    assert left_in(tmp_path) == ["a.txt"]


def test_a_link_that_leads_nowhere_is_there_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("target")
    with pytest.raises(ps.InputError, match="exists; nothing is overwritten"):
        write_file(tmp_path / "link", "x")
    write_file(tmp_path / "link", "x", overwrite=True)
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "x"


def test_a_replaced_file_keeps_its_permissions(tmp_path: Path) -> None:
    target = write_file(tmp_path / "a.txt", "x")
    target.chmod(0o640)
    write_file(target, "y", overwrite=True)
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none/a.txt", r"none is not a folder"),
        ("a\0b", "cannot be written: .*embedded null"),
        (300 * "x", "cannot be written: File name too long"),
        ("circle", "cannot be written: (Symlink loop|Too many levels)"),
        ("folder", "folder is not a file, and is not replaced; name another one"),
        ("pipe", "pipe is not a file, and is not replaced; name another one"),
    ],
)
def test_a_place_where_no_file_can_be(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "circle").symlink_to("circle")
    (tmp_path / "folder").mkdir()
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ps.InputError, match=message):
        write_file(tmp_path / name, "x", overwrite=True)
    assert left_in(tmp_path) == ["circle", "folder", "pipe"]


@pytest.mark.parametrize("size", [0, 1, 4096, 100_000])
def test_a_full_disk_leaves_the_old_file(size: int, tmp_path: Path) -> None:
    """`--html` left half a page under the name of the page before it."""
    resource = pytest.importorskip("resource")
    (tmp_path / "a.txt").write_text("old")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        with pytest.raises(ps.InputError, match=r"a\.txt': cannot be written: File too large"):
            write_file(tmp_path / "a.txt", 200_000 * "x", overwrite=True)
        with pytest.raises(ps.InputError, match=r"b\.txt': cannot be written: File too large"):
            write_file(tmp_path / "b.txt", 200_000 * "x")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (tmp_path / "a.txt").read_text() == "old"
    assert left_in(tmp_path) == ["a.txt"]


def test_a_file_system_without_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Such as that of most memory cards: there an empty file holds the name."""

    def refuse(*_: Any) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", refuse)
    target = write_file(tmp_path / "a.txt", "x")
    with pytest.raises(ps.InputError, match="exists; nothing is overwritten"):
        write_file(target, "y")
    assert target.read_text() == "x"
    assert left_in(tmp_path) == ["a.txt"]


def test_content_is_on_the_disk_before_it_has_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a loss of power a name without its content is worse than no name."""
    order: list[str] = []
    real = os.fsync

    def fsync(handle: int) -> None:
        order.append("named" if (tmp_path / "a").exists() else "hidden")
        real(handle)

    monkeypatch.setattr(os, "fsync", fsync)
    write_file(tmp_path / "a", "x")
    assert order == ["hidden", "named"]  # the file, then the folder
    (tmp_path / "a").unlink()
    order.clear()
    with new_folder(tmp_path / "a") as folder:
        (folder / "b").write_text("x")
    assert order == ["hidden", "hidden", "named"]


# ---- folders


def test_an_existing_folder_stays_the_same_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It was replaced: its mode 02770 became 0755, and the shell stood in a folder that was no more."""
    target = tmp_path / "results"
    target.mkdir()
    target.chmod(0o2770)
    before = target.stat()
    monkeypatch.chdir(target)
    with new_folder(".") as folder:
        (folder / "inner").mkdir()
        (folder / "inner" / "a.txt").write_text("a")
    after = target.stat()
    assert (after.st_ino, after.st_mode) == (before.st_ino, before.st_mode)
    assert left_in(target) == ["inner"]
    assert (target / "inner" / "a.txt").read_text() == "a"


def test_an_empty_folder_is_never_seen_half_full(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kill between two of twenty files left the first ones under the final name, and the others were swept away."""
    target, seen, real = tmp_path / "results", list[list[str]](), Path.replace
    target.mkdir()

    def replace(path: Path, place: Path) -> Path:
        seen.append(left_in(target) if target.exists() else [])  # what a kill at this instant leaves
        return real(path, place)

    monkeypatch.setattr(Path, "replace", replace)
    with new_folder(target) as folder:
        for name in "abc":
            (folder / name).touch()
    assert seen == [[], [], []]
    assert left_in(target) == ["a", "b", "c"]


@pytest.mark.parametrize("is_mounted", [False, True])
def test_a_folder_that_cannot_be_filled_is_empty_again(
    is_mounted: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target, real = tmp_path / "results", Path.replace
    target.mkdir()
    before = target.stat().st_ino
    if is_mounted:  # nothing can be renamed that is a mount point
        monkeypatch.setattr(Path, "rename", _busy)

    def replace(path: Path, place: Path) -> Path:
        if path.name == "b":
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(path, place)

    monkeypatch.setattr(Path, "replace", replace)
    writer = new_folder(target)
    folder = writer.__enter__()
    for name in "abc":
        (folder / name).touch()
    with pytest.raises(ps.InputError, match="results: No space left on device"):
        writer.__exit__(None, None, None)
    assert (target.stat().st_ino, left_in(target), left_in(tmp_path)) == (before, [], ["results"])


def _busy(*_: Any) -> None:
    raise OSError(errno.EBUSY, "Device or resource busy")


def test_a_folder_whose_parent_is_not_ours_can_be_filled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A mount point, as ``docker -v`` makes: nothing can be renamed onto it, and beside it is another disk."""
    target = tmp_path / "mounted"
    target.mkdir()
    real = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != tmp_path and real(path, mode))
    with new_folder(target) as folder:
        assert folder.parent == target
        (folder / "a.txt").write_text("a")
    assert left_in(target) == ["a.txt"]


def test_asked_to_a_folder_keeps_what_is_not_written_anew(tmp_path: Path) -> None:
    target = tmp_path / "results"
    (target / "inner").mkdir(parents=True)
    for name in ("old.txt", "both.txt", "inner/old.txt"):
        (target / name).write_text("old")
    with new_folder(target, overwrite=True) as folder:
        (folder / "inner").mkdir()
        for name in ("both.txt", "new.txt", "inner/new.txt"):
            (folder / name).write_text("new")
    found = {str(path.relative_to(target)): path.read_text() for path in target.rglob("*.txt")}
    assert found == {
        "old.txt": "old", "both.txt": "new", "new.txt": "new", "inner/old.txt": "old", "inner/new.txt": "new",
    }  # fmt: skip


def test_one_of_two_writers_fills_a_folder(tmp_path: Path) -> None:
    """Both had found it empty."""
    (tmp_path / "results").mkdir()
    first, second = new_folder(tmp_path / "results"), new_folder(tmp_path / "results")
    for writer, text in ((first, "1"), (second, "2")):
        (writer.__enter__() / "a.txt").write_text(text)
    first.__exit__(None, None, None)
    with pytest.raises(ps.InputError, match="another run has filled it"):
        second.__exit__(None, None, None)
    assert left_in(tmp_path / "results") == ["a.txt"]
    assert (tmp_path / "results" / "a.txt").read_text() == "1"


@pytest.mark.parametrize("exists", [False, True])
def test_of_many_writers_one_wins(exists: bool, tmp_path: Path) -> None:
    target = tmp_path / "results"
    if exists:
        target.mkdir()
    start, outcomes = Barrier(8), list[str]()

    def write(k: int) -> None:
        start.wait()
        try:
            with new_folder(target) as folder:
                for name in "ab":
                    (folder / name).write_text(str(k))
            outcomes.append("written")
        except ps.InputError:
            outcomes.append("refused")

    writers = [Thread(target=write, args=(k,)) for k in range(8)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert sorted(outcomes) == ["refused"] * 7 + ["written"]
    assert left_in(target) == ["a", "b"]
    assert (target / "a").read_text() == (target / "b").read_text()
    assert left_in(tmp_path) == ["results"]


# ---- what a killed run leaves


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_a_killed_run_leaves_nothing_that_the_next_one_keeps(kind: str, tmp_path: Path) -> None:
    """41 of 50 kills left a hidden folder for good."""
    for wait in (0.0, 0.004, 0.011):
        command = [sys.executable, "-c", WRITER, kind, str(tmp_path / "page.html" if kind == "file" else tmp_path)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as writer:
            assert writer.stdout is not None
            writer.stdout.readline()
            time.sleep(wait)
            writer.kill()
        for path in tmp_path.iterdir():
            if path.name == "page.html":
                assert path.stat().st_size == 200_000
            elif not path.name.startswith("."):
                assert left_in(path) == ["a", "b", "c"]
    write_file(tmp_path / "next", "")
    assert not [name for name in left_in(tmp_path) if name.startswith(".")]


def test_what_another_run_is_writing_is_left_alone(tmp_path: Path) -> None:
    with new_folder(tmp_path / "slow") as folder:
        write_file(tmp_path / "quick", "")
        assert folder.is_dir()
    assert left_in(tmp_path) == ["quick", "slow"]


def test_a_trap_with_the_name_of_a_leftover_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "a.txt").touch()
    (tmp_path / ".puma-septic-link.part").symlink_to("precious")
    os.mkfifo(tmp_path / ".puma-septic-pipe.part")
    write_file(tmp_path / "b", "")
    assert left_in(tmp_path / "precious") == ["a.txt"]


# ---- names


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["left/axis", "right/axis"], ["left_axis", "right_axis"]),
        (["a$b_{$c", "a b", "a\tb", "a\u202eb"], ["a_b___c", "a_b", "a_b-2", "a_b-3"]),
        (["..", ".", "/", ""], ["_", "_-2", "_-3", "_-4"]),
        (["Straße", "STRASSE"], ["Straße", "STRASSE-2"]),
        (["e\u0301", "\u00e9"], ["\u00e9", "\u00e9-2"]),
        (["\ud800"], ["_"]),
    ],
)  # fmt: skip
def test_any_name_makes_a_file_name_of_its_own(names: list[str], expected: list[str]) -> None:
    """Joints left/axis and right/axis both became load-profile-axis.csv, one of them lost."""
    assert file_names(names) == expected


def test_long_names_are_cut_between_letters() -> None:
    """200 letters of another script are 400 bytes, more than a file system takes: no result at all."""
    found = file_names([200 * "關", 200 * "關"])
    assert [len(name.encode()) for name in found] == [99, 101]
