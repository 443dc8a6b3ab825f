"""A folder of results that is there as a whole or not at all."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

from puma_septic.errors import InputError

__all__ = ["file_names", "new_folder"]


@contextmanager
def new_folder(path: str | Path, *, overwrite: bool = False) -> Iterator[Path]:
    """A folder to write into, which takes its name when all is written.

    What is yielded is a hidden folder beside the wanted one; it is renamed at the end, and removed if anything goes
    wrong inside, so that nobody finds half of a result.

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
    target = _checked(Path(path), overwrite=overwrite)
    partial = target.parent / f".{target.name}.{token_hex(4)}.part"
    try:
        partial.mkdir()
        yield partial
        if overwrite and target.is_dir():
            shutil.copytree(partial, target, dirs_exist_ok=True)
        else:
            partial.replace(target)  # of an empty folder as well; one that has been filled meanwhile is refused
    except OSError as error:
        raise InputError(f"cannot write the folder {path}: {error.strerror or error}") from error
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def file_names(names: Sequence[str]) -> list[str]:
    """Names of joints as parts of file names, one each: what separates folders becomes "_", doubles get a number.

    Examples
    --------
    >>> file_names(["left/joint_1", "right/joint_1", "left_joint_1"])
    ['left_joint_1', 'right_joint_1', 'left_joint_1-2']
    """
    found: list[str] = []
    for name in names:
        plain = "".join("_" if letter in '/\\:*?"<>|' else letter for letter in name).lstrip(".") or "_"
        taken = {one.lower() for one in found}  # of which some file systems know one alone
        numbered = [plain, *(f"{plain}-{k}" for k in range(2, len(names) + 2))]
        found.append(next(one for one in numbered if one.lower() not in taken))
    return found


def _checked(path: Path, *, overwrite: bool) -> Path:
    try:
        target = path.resolve()
        if target.is_dir() and any(target.iterdir()) and not overwrite:
            raise InputError(
                f"the folder {path} is not empty; nothing in it is overwritten without --force; or name another one"
            )
        if target.exists() and not target.is_dir():
            raise InputError(f"{path} is a file; name a folder that does not exist yet")
        if not target.parent.is_dir():
            raise InputError(f"cannot write the folder {path}: {target.parent} is not a folder")
    except (
        OSError,
        RuntimeError,
        ValueError,
    ) as error:  # RuntimeError: links in a circle; ValueError: a null character
        if isinstance(error, InputError):
            raise
        raise InputError(f"cannot write the folder {str(path)!r}: {error}") from error
    return target
