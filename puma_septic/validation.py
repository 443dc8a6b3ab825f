"""Arrays and numbers at the door: float64, the right shape, finite, read-only; mappings that stay as they are."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any, Final, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, did_you_mean

__all__ = [
    "LARGEST",
    "Array",
    "FrozenMap",
    "checked_array",
    "checked_choice",
    "checked_kind",
    "checked_list",
    "checked_number",
    "checked_texts",
    "checked_times",
    "checked_whole",
    "freeze_fields",
    "frozen",
    "n_dimensions",
    "numbers",
    "read_only",
    "store_needed",
    "store_numbers",
]

Array = NDArray[np.float64]

LARGEST: Final = 1e30
"""What no quantity of an arm exceeds, in SI units: products of ten of them are still finite."""
# s; the seventh power of its inverse is still finite.
_SHORTEST: Final = 1e-30
AnyArray = TypeVar("AnyArray", bound=NDArray[np.generic])
Key = TypeVar("Key")
Kind = TypeVar("Kind")
Value = TypeVar("Value", covariant=True)


@final
class FrozenMap(Mapping[Key, Value]):
    """A copy of a mapping that cannot be written, and, other than `types.MappingProxyType`, can be pickled and copied.

    Examples
    --------
    >>> FrozenMap({"a": 1})
    {'a': 1}
    """

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[Key, Value]) -> None:
        self._items = dict(items)

    def __getitem__(self, key: Key) -> Value:
        return self._items[key]

    def __iter__(self) -> Iterator[Key]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __repr__(self) -> str:
        return repr(self._items)


def read_only(array: ArrayLike) -> Array:
    """Return a read-only float64 copy."""
    copy = np.array(array, dtype=np.float64)
    copy.setflags(write=False)
    return copy


def frozen(array: AnyArray) -> AnyArray:
    """The same array, which its maker alone has, without leave to write.

    Examples
    --------
    >>> frozen(np.zeros(2)).flags.writeable
    False
    """
    array.setflags(write=False)
    return array


def freeze_fields(value: Any) -> None:
    """Forbid writing to the arrays, and copy the mappings, that a value has just been made of."""
    for field in fields(value):
        given = getattr(value, field.name, None)
        if isinstance(given, np.ndarray):
            frozen(given)
        elif isinstance(given, Mapping):
            object.__setattr__(value, field.name, FrozenMap(given))


def checked_array(
    name: str,
    value: ArrayLike,
    shape: Sequence[int | None] | None,
    *,
    unit: str = "",
    allow_nan: bool = False,
    largest: float = LARGEST,
) -> Array:
    """Return `value` as a read-only float64 copy of the given shape.

    Parameters
    ----------
    name : str
        How the message calls the argument.
    shape : sequence of int or None, or None
        Expected shape; None leaves a length free, or all of it.
    unit : str
        Unit named in the message.
    allow_nan : bool
        Accept NaN as "unknown" (limits); infinities are refused in any case.
    largest : float
        Magnitude up to which a number is accepted.

    Raises
    ------
    InputError
        With name, offending index and value, and what would be valid.
    """
    array = read_only(numbers(name, value, shape))
    if shape is not None and not _fits(array.shape, shape):
        raise InputError(f"{name}: shape {array.shape} is not {_describe(shape)}")
    valid = ~np.isinf(array) if allow_nan else np.abs(array) <= largest
    if np.count_nonzero(valid) < valid.size:
        index = tuple(int(i) for i in np.argwhere(~valid)[0])
        where = f"[{', '.join(map(str, index))}]" if index else ""
        suffix = f" {unit}" if unit else ""
        why = f"beyond {largest:g}, as no quantity of an arm is" if np.isfinite(array[index]) else "not a finite number"
        raise InputError(f"{name}{where} = {float(array[index])}{suffix} is {why}")
    return array


def numbers(name: str, value: ArrayLike, shape: Sequence[int | None] | None = None) -> Array:
    """Return `value` as float64, itself where it is that already; it need not be finite.

    NumPy would take "1", True, the real part of 1 + 2j and what is behind a mask for numbers, and raise errors of its
    own for rows of different lengths.

    Parameters
    ----------
    name : str
        How the message calls the argument.
    shape : sequence of int or None, or None
        For the message.

    Raises
    ------
    InputError
        For what is no array of numbers, or one of which some are masked.
    """
    if type(value) is np.ndarray and value.dtype == np.float64:
        return value
    if _is_masked(value):
        raise InputError(f"{name}: some of its numbers are masked; leave them out, or fill them")
    try:
        given = np.asarray(value)
        if value is None or given.dtype.kind not in "iufO" or (given.dtype.kind == "O" and _holds_text_or_truth(given)):
            raise TypeError(f"not numbers: {given.dtype}")
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        wanted = "numbers" if shape is None else f"numbers of shape {_describe(shape)}"
        raise InputError(f"{name}: expected {wanted}, got {reprlib.repr(value)}") from error


def n_dimensions(value: ArrayLike | None) -> int:
    """0 of a number, 1 of a list of them, and so on; -1 of what is no array of numbers, as rows of different lengths.

    Examples
    --------
    >>> n_dimensions(1.0), n_dimensions([1.0]), n_dimensions([[1.0], [1.0, 2.0]])
    (0, 1, -1)
    """
    if _is_masked(value):
        return -1
    try:
        return int(np.ndim(value))  # type: ignore[arg-type]
    except ValueError:
        return -1


def store_numbers(value: object, units: Mapping[str, str], **bounds: float) -> None:
    """Hold every field of a new value that `units` names to the bounds, unless it is NaN, and store it as a float."""
    for name, unit in units.items():
        given = getattr(value, name)
        if not (isinstance(given, (float, np.floating)) and np.isnan(given)):
            store_needed(value, {name: unit}, **bounds)


def store_needed(value: object, units: Mapping[str, str], **bounds: float) -> None:
    """`store_numbers` of what must be known."""
    for name, unit in units.items():
        object.__setattr__(value, name, checked_number(name, getattr(value, name), unit=unit, **bounds))


def checked_kind(name: str, value: Kind, kind: type[Any] | tuple[type[Any], ...]) -> Kind:
    """Return `value` if it is one of ours; anything else in its place would be found out much later, if at all."""
    if not isinstance(value, kind):
        kinds = " or ".join(one.__name__ for one in (kind if isinstance(kind, tuple) else (kind,)))
        raise InputError(f"{name}: expected {kinds}(...), got {reprlib.repr(value)}")
    return value


def checked_list(name: str, value: Iterable[Kind]) -> tuple[Kind, ...]:
    """Return what can be gone through as a tuple; a text is no list of its letters."""
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        raise InputError(f"{name}: expected a list, got {reprlib.repr(value)}")
    return tuple(value)


def checked_texts(name: str, value: Iterable[str] | None) -> tuple[str, ...]:
    """Return texts as a tuple, empty for None; one text is no list of its letters."""
    texts = () if value is None else checked_list(name, value)
    if not all(isinstance(one, str) for one in texts):
        raise InputError(f"{name}: expected a list of texts, got {reprlib.repr(value)}")
    return texts


def checked_whole(name: str, value: int, *, at_least: int | None = None, at_most: int | None = None) -> int:
    """Return `value` as an int within the bounds; 3.0 is no whole number, nor is True."""
    is_whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_whole or (at_least is not None and value < at_least) or (at_most is not None and value > at_most):
        bounds = ("" if at_least is None else f" from {at_least}") + ("" if at_most is None else f" to {at_most}")
        raise InputError(f"{name} = {reprlib.repr(value)}: expected a whole number{bounds}")
    return int(value)


def checked_number(
    name: str,
    value: object,
    *,
    unit: str = "",
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
) -> float:
    """Return `value` as a finite float within the given bounds (`above` is exclusive)."""
    suffix = f" {unit}" if unit else ""
    if isinstance(value, (bool, np.bool_, str)) or value is None:
        raise InputError(f"{name}: expected a number{suffix and ' in' + suffix}, got {reprlib.repr(value)}")
    number = float(checked_array(name, value, (), unit=unit))  # type: ignore[arg-type]
    if above is not None and not number > above:
        raise InputError(f"{name} = {number:g}{suffix} must be greater than {above:g}{suffix}")
    if above == 0 and number < 1 / LARGEST:
        raise InputError(f"{name} = {number:g}{suffix} must be at least {1 / LARGEST:g}{suffix}")
    if at_least is not None and not number >= at_least:
        raise InputError(f"{name} = {number:g}{suffix} must be at least {at_least:g}{suffix}")
    if at_most is not None and not number <= at_most:
        raise InputError(f"{name} = {number:g}{suffix} must be at most {at_most:g}{suffix}")
    return number


def checked_times(name: str, value: ArrayLike, count: int | None = None) -> Array:
    """Return strictly increasing times in s; a message names the first pair that is not."""
    times = checked_array(name, value, (count,), unit="s")
    steps = times[1:] - times[:-1]
    if not (steps > 0).all():
        k = int(np.argmin(steps > 0))
        raise InputError(
            f"{name}: must increase strictly, but {name}[{k}] = {times[k]:.12g} s is followed by {times[k + 1]:.12g} s"
        )
    if not (steps >= _SHORTEST).all():
        k = int(np.argmin(steps))
        raise InputError(
            f"{name}[{k}] = {times[k]:.12g} s and {name}[{k + 1}] = {times[k + 1]:.12g} s are too close to each other"
        )
    return times


def checked_choice(name: str, value: str, valid: Iterable[str]) -> str:
    """Return `value` if it is one of the valid names, which the message lists otherwise."""
    names = list(valid)
    if value not in names:
        meant = did_you_mean([value], names) if isinstance(value, str) else ""
        raise InputError(f"unknown {name} {value!r}; valid: {', '.join(map(repr, names))}{meant}")
    return value


def _holds_text_or_truth(array: NDArray[np.object_]) -> bool:
    return any(isinstance(item, (str, bytes, bool, np.bool_)) for item in array.flat)


def _is_masked(value: object) -> bool:
    if isinstance(value, (list, tuple)):
        return any(map(_is_masked, value))
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.is_masked(value))


def _fits(shape: Sequence[int], wanted: Sequence[int | None]) -> bool:
    pairs = zip(shape, wanted, strict=False)
    return len(shape) == len(wanted) and all(want is None or have == want for have, want in pairs)


def _describe(shape: Sequence[int | None]) -> str:
    free = iter("nmk")  # (n, n) would ask for a square
    lengths = ", ".join(next(free) if length is None else str(length) for length in shape)
    return f"({lengths}{',' if len(shape) == 1 else ''})"
