"""From a YAML file to a Task; whatever is wrong with the file is an InputError that says where."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from puma_septic.errors import InputError, did_you_mean
from puma_septic.files import YamlPlaces, checked_path, decoded, read_bytes, yaml_documents, yaml_places, yaml_text
from puma_septic.task._fields import MARKS, OWN_WORDS, shortened
from puma_septic.task._schema import Task

__all__ = ["load_task", "make_task", "parse_task", "task_names", "task_text"]

# The built-in tasks are 2 KB long; a pure-Python YAML parser takes seconds for some 100 KB.
MAX_BYTES: Final = 64_000
MAX_DEPTH: Final = 16  # the schema needs five; the parser's recursion ends at some 300
_FOLDER: Final = Path(__file__).resolve().parents[1] / "tasks"


def task_names() -> tuple[str, ...]:
    """Names of the built-in tasks.

    Examples
    --------
    >>> task_names()
    ('gasparetto-zanotto', 'lin-chang-luh', 'paper', 'paper-straight', 'paper-turned', 'williams')
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.yaml")))


def load_task(source: str | Path) -> Task:
    """Read a task file (YAML 1.2), or a built-in task by its name.

    Parameters
    ----------
    source : str or Path
        A name out of `task_names`, such as "paper", or the path of a .yaml or .yml file; paths in it are relative to
        its folder.

    Returns
    -------
    Task

    Raises
    ------
    InputError
        For a file that is missing, over 64 kB, not UTF-8 or not YAML, has anchors, duplicate or unknown keys,
        or values that are not valid; it names file, field, value and what would be valid.

    Examples
    --------
    >>> task = load_task("paper")
    >>> task.times, [profile.name for profile in task.profiles]
    ((0.0, 2.0, 6.0, 9.0), ['septic', 'lspb', 'quintic_segments'])
    """
    path = checked_path(source, "task file")
    if isinstance(source, str) and path.name == source and path.suffix not in (".yaml", ".yml"):
        names = task_names()
        if source not in names:
            valid = ", ".join(map(repr, names))
            raise InputError(
                f"unknown task {source!r}; valid: {valid}, or the path of a .yaml file{did_you_mean([source], names)}"
            )
        path = _FOLDER / f"{source}.yaml"
        return parse_task(_read(path), origin=f"built-in task {source!r}", folder=_FOLDER)
    return parse_task(_read(path), origin=str(path), folder=path.resolve().parent)


def parse_task(text: str, *, origin: str = "task", folder: str | Path = ".") -> Task:
    """A task from YAML text; `origin` is what messages call it, relative paths in it begin at `folder`."""
    data = _parsed(text, origin)
    return _validated(data, origin, folder, lambda: yaml_places(text))


def make_task(data: Mapping[str, Any], *, origin: str = "task", folder: str | Path = ".") -> Task:
    """A task from a mapping with a task file's keys, such as `Task.document` returns.

    Raises
    ------
    InputError
        Naming the field, its value and what would be valid.
    """
    return _validated(data, origin, folder, lambda: None)


def _validated(data: Any, origin: str, folder: str | Path, places: Callable[[], YamlPlaces | None]) -> Task:
    try:
        return Task.model_validate(data, context={"origin": origin, "folder": str(folder)})
    except ValidationError as error:
        raise InputError(_described(error, origin, places())) from error


def task_text(task: Task, *, comment: str = "") -> str:
    """A task as YAML, which `parse_task` takes back; paths in it are absolute.

    Returns
    -------
    str

    Examples
    --------
    >>> task = load_task("paper")
    >>> parse_task(task_text(task)).document() == task.document()
    True
    """
    head = "".join(f"# {line}\n" for line in comment.splitlines())
    return head + yaml_text(task.document())


def _read(path: Path) -> str:
    return decoded(read_bytes(path, what="task file", at_most=MAX_BYTES), path)


def _parsed(text: str, origin: str) -> Any:
    """The one YAML document as plain values."""
    documents = yaml_documents(text, origin, max_depth=MAX_DEPTH)
    if len(documents) > 1:
        raise InputError(f"{origin}: not valid YAML: one document is expected, it has {len(documents)}")
    return documents[0] if documents else None


# pydantic's own words where ours are shorter or name the file's terms.
_MESSAGES: Final = {
    "missing": "is missing",
    "literal_error": "expected {expected}",
    "float_type": "expected a number",
    "string_type": "expected text",
    "tuple_type": "expected a list",
    "dict_type": "expected a mapping",
    "finite_number": "expected a finite number",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "too_short": "expected at least {min_length} entries",
    "too_long": "expected at most {max_length} entries",
}


def _described(error: ValidationError, origin: str, places: YamlPlaces | None) -> str:
    """All faults, each with its line, its field, what is wrong and the value."""
    faults = error.errors(include_url=False)
    told = [(_line(fault, places), _message(fault)) for fault in faults if not _is_echo(fault, faults)]
    if len(told) == 1:
        ((line, message),) = told
        return f"{origin}{f', line {line}' if line else ''}: {message}"
    lines = (f"{f'line {line}: ' if line else ''}{message}" for line, message in sorted(told, key=lambda one: one[0]))
    return f"{origin}: {len(told)} faults:" + "".join(f"\n  {line}" for line in lines)


def _is_echo(fault: ErrorDetails, faults: Sequence[ErrorDetails]) -> bool:
    """Whether a list is said to be too short only because of an entry that is told itself."""
    n = len(fault["loc"])
    inner = [one for one in faults if len(one["loc"]) > n and one["loc"][:n] == fault["loc"]]
    return fault["type"] == "too_short" and bool(inner)


def _line(fault: ErrorDetails, places: YamlPlaces | None) -> int:
    """The line of the file that a fault stands in, 0 where there is no file."""
    if places is None:
        return 0
    key = fault.get("ctx", {}).get("key")
    return places.line([part for part in (*fault["loc"], *(() if key is None else (key,))) if part not in MARKS])


def _message(fault: ErrorDetails) -> str:
    where = _field(fault["loc"])
    message = _MESSAGES.get(fault["type"], fault["msg"])
    if fault["type"] in _MESSAGES:
        message = message.format(**fault.get("ctx", {}))
    text = f"{where}{' ' if fault['type'] == 'missing' else ': '}{message}" if where else message
    if fault["type"] not in ("missing", OWN_WORDS):
        text += f", got {shortened(fault['input'])}"
    return text


def _field(location: tuple[int | str, ...]) -> str:
    """``points[2].position[1]`` for ("points", 2, "position", 1)."""
    text = ""
    for part in location:
        if isinstance(part, int):
            text += f"[{part}]"
        elif part not in MARKS:
            text += f".{part}" if text else part
    return text
