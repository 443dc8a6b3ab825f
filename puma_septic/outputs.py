"""Files and folders that are there whole or not at all.

What is being written has a hidden name of its own, ``.puma-septic-XXXXXXXX.part``, in the folder that it will be in. It
reaches the disk (fsync) before it takes its name, so that no crash leaves half of it under that name. A lock says that
its process lives: what a killed run has left is held by nobody, and the next run that writes there removes it.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import stat
import unicodedata
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from secrets import token_hex
from typing import Final

from puma_septic.errors import InputError
from puma_septic.files import checked_path, kind_of, why
from puma_septic.validation import checked_flag

__all__ = ["file_names", "new_folder", "write_file"]

_PREFIX: Final = ".puma-septic-"
_SUFFIX: Final = ".part"
# Of a part of a file's name, in bytes: all file systems take 255, and something is put before and behind.
_LONGEST_NAME: Final = 100


def write_file(path: str | Path, content: str | bytes, *, overwrite: bool = False) -> Path:
    """Write a file beside its name and give it the name when all of it is on the disk.

    Parameters
    ----------
    path : str or Path
        Its folder must exist. Of a link, the file that it leads to is written.
    content : str or bytes
        Text is written in UTF-8.
    overwrite : bool
        Whether it may replace a file, whose permissions it then has.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        Where it exists and may not be replaced, or cannot be written, with the reason; what was there is untouched.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_file(Path(folder, "a.txt"), "once")
    ...     path.read_text()
    'once'
    """
    target = checked_path(path, "file or folder")
    checked_flag("overwrite", overwrite)
    try:
        if os.path.lexists(target) and not overwrite:
            raise FileExistsError
        place = target.resolve()
        if kind_of(place) not in (0, stat.S_IFREG):
            raise InputError(f"{target} is not a file, and is not replaced; name another one")
        if not place.parent.is_dir():
            raise InputError(f"{str(target)!r}: cannot be written: {place.parent} is not a folder")
        with _unfinished(place.parent) as partial:
            partial.write_bytes(content.encode() if isinstance(content, str) else content)
            _take_name(partial, place, overwrite=overwrite)
    except FileExistsError as error:
        raise InputError(f"{target} exists; nothing is overwritten, name another file") from error
    # RuntimeError: links in a circle; ValueError: a null character, half of a surrogate pair
    except (OSError, RuntimeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{str(target)!r}: cannot be written: {why(error)}") from error
    return target


@contextmanager
def new_folder(path: str | Path, *, overwrite: bool = False) -> Iterator[Path]:
    """A folder to write into, which takes its name when all is written.

    What is yielded is a hidden folder, which is removed if anything goes wrong inside, so that nobody finds half of a
    result. A folder that exists stays the same one, with its owner and permissions: the files are moved into it, out of
    sight where it is empty. With content, or a mount point, it is filled file by file: each is the old or the new one.

    Parameters
    ----------
    path : str or Path
        A folder that does not exist, or is empty; its parent must exist.
    overwrite : bool
        Whether the folder may have content. Files of the same names are replaced, all others stay.

    Raises
    ------
    InputError
        If the folder has content, which is overwritten only on request, or cannot be written.
    """
    target = _checked(checked_path(path, "file or folder"), overwrite=checked_flag("overwrite", overwrite))
    exists = target.is_dir()
    try:
        with _unfinished(_workshop(target), is_folder=True) as partial:
            yield partial
            for item in partial.rglob("*"):
                _to_disk(item)
            _to_disk(partial)
            if exists or target.is_dir():
                _fill(target, partial, path, overwrite=overwrite)
            else:
                partial.replace(target)
                _to_disk(target.parent)
    except OSError as error:
        raise InputError(f"cannot write the folder {path}: {why(error)}") from error


def file_names(names: Sequence[str]) -> list[str]:
    """Any names as parts of file names, one each: other than letters, digits, ".", "-" and "_" become "_".

    Names that would be one, also where a file system does not tell capitals apart, get a number; long ones are cut.

    Examples
    --------
    >>> file_names(["left/joint 1", "right/joint 1", "left_joint_1", "../a$b"])
    ['left_joint_1', 'right_joint_1', 'left_joint_1-2', '_a_b']
    """
    found: list[str] = []
    taken: set[str] = set()
    for name in names:
        letters = unicodedata.normalize("NFC", name).lstrip(".")
        plain = "".join(letter if letter.isalnum() or letter in "._-" else "_" for letter in letters)
        plain = plain.encode("utf-8", "replace")[:_LONGEST_NAME].decode("utf-8", "ignore").rstrip(".") or "_"
        numbered = (plain, *(f"{plain}-{k}" for k in range(2, len(names) + 2)))
        found.append(next(one for one in numbered if one.casefold() not in taken))
        taken.add(found[-1].casefold())
    return found


def _checked(path: Path, *, overwrite: bool) -> Path:
    try:
        target = path.resolve()
        kind = kind_of(target)
        if stat.S_ISDIR(kind) and _is_filled(target) and not overwrite:
            raise InputError(
                f"the folder {path} is not empty; nothing in it is overwritten without --force; or name another one"
            )
        if kind and not stat.S_ISDIR(kind):
            raise InputError(f"{path} is a file; name a folder that does not exist yet")
        if not target.parent.is_dir():
            raise InputError(f"cannot write the folder {path}: {target.parent} is not a folder")
    # RuntimeError: links in a circle; ValueError: a null character
    except (OSError, RuntimeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"cannot write the folder {str(path)!r}: {error}") from error
    return target


def _workshop(target: Path) -> Path:
    """Where a folder is written before it is moved: beside it, but inside a mount point or where only it is ours."""
    beside = target.parent
    is_near = not target.is_dir() or (beside.stat().st_dev == target.stat().st_dev and os.access(beside, os.W_OK))
    return beside if is_near else target


def _is_filled(folder: Path) -> bool:
    """Whether it has anything but what another run is writing, or has left."""
    return any(not _is_unfinished(name) for name in os.listdir(folder))


def _is_unfinished(name: str) -> bool:
    return name.startswith(_PREFIX) and name.endswith(_SUFFIX)


@contextmanager
def _unfinished(folder: Path, *, is_folder: bool = False) -> Iterator[Path]:
    """A new file or folder of a hidden name, held by this process; it is removed if it keeps that name."""
    _sweep(folder)
    partial, handle = _held(folder, is_folder=is_folder)
    while partial is None:
        partial, handle = _held(folder, is_folder=is_folder)
    try:
        yield partial
    finally:
        _remove(partial)
        os.close(handle)


def _held(folder: Path, *, is_folder: bool) -> tuple[Path | None, int]:
    """A new one and what holds it; None where another run took it for a leftover before it was held."""
    partial = folder / f"{_PREFIX}{token_hex(4)}{_SUFFIX}"
    if is_folder:
        partial.mkdir()
    else:
        partial.touch(exist_ok=False)
    handle = os.open(partial, os.O_RDONLY)
    with suppress(OSError):  # a file system without locks; there nothing is swept either
        fcntl.flock(handle, fcntl.LOCK_EX)
    with suppress(FileNotFoundError):
        if os.path.samestat(os.fstat(handle), partial.stat()):
            return partial, handle
    os.close(handle)
    return None, -1


def _sweep(folder: Path) -> None:
    """Remove what killed runs have left: unfinished and held by nobody."""
    for name in filter(_is_unfinished, os.listdir(folder)):
        with suppress(OSError):  # gone meanwhile, somebody else's, or held
            handle = os.open(folder / name, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                _remove(folder / name)
            finally:
                os.close(handle)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _take_name(partial: Path, place: Path, *, overwrite: bool) -> None:
    """Rename a file whose content is on the disk; FileExistsError where that would replace one that may not be."""
    if overwrite and place.exists():
        partial.chmod(stat.S_IMODE(place.stat().st_mode))
    _to_disk(partial)
    if not overwrite:
        try:
            os.link(partial, place)
        except FileExistsError:
            raise
        except OSError:  # a file system without links: an empty file holds the name until it is replaced
            place.touch(exist_ok=False)
            partial.replace(place)
    else:
        partial.replace(place)
    _to_disk(place.parent)


def _fill(target: Path, partial: Path, path: str | Path, *, overwrite: bool) -> None:
    """Move the content of a folder into one that exists, if nobody else has filled it."""
    handle = os.open(target, os.O_RDONLY)
    try:
        with suppress(OSError):  # a file system without locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        if not _is_filled(target):
            _fill_empty(target, partial)
        elif overwrite:
            _move(partial, target)
        else:
            raise InputError(f"cannot write the folder {path}: another run has filled it")
        _to_disk(target)
        _to_disk(target.parent)
    finally:
        os.close(handle)


def _fill_empty(target: Path, partial: Path) -> None:
    """Fill a folder while it stands inside the hidden one: a kill between two files leaves nothing to be seen."""
    place = partial / partial.name
    try:
        target.rename(place)
    except OSError:  # a mount point, a folder that is not ours to rename, or the hidden one stands inside it
        place = target
    try:
        _move(partial, place)
        _to_disk(place)
    except BaseException:
        _move(place, partial)
        raise
    finally:
        if place != target:
            place.rename(target)


def _move(source: Path, target: Path) -> None:
    for item in sorted(item for item in source.iterdir() if not _is_unfinished(item.name)):
        place = target / item.name
        if item.is_dir() and place.is_dir():
            _move(item, place)
        else:
            item.replace(place)


def _to_disk(path: Path) -> None:
    """Wait until a file's content, or a folder's names, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError:
        if not path.is_dir():  # whose names not every file system can write out
            raise
    finally:
        os.close(handle)
