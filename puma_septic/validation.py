"""Arrays and numbers at the door: float64, the right shape, finite, read-only; mappings that stay as they are."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, did_you_mean

__all__ = [
    "Array",
    "FrozenMap",
    "checked_array",
    "checked_choice",
    "checked_number",
    "checked_times",
    "freeze_fields",
    "frozen",
    "read_only",
]

Array = NDArray[np.float64]
AnyArray = TypeVar("AnyArray", bound=NDArray[np.generic])
Key = TypeVar("Key")
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
    name: str, value: ArrayLike, shape: Sequence[int | None], *, unit: str = "", allow_nan: bool = False
) -> Array:
    """Return `value` as a read-only float64 copy of the given shape.

    Parameters
    ----------
    name : str
        How the message calls the argument.
    shape : sequence of int or None
        Expected shape; None leaves a length free.
    unit : str
        Unit named in the message.
    allow_nan : bool
        Accept NaN as "unknown" (limits); infinities are refused in any case.

    Raises
    ------
    InputError
        With name, offending index and value, and what would be valid.
    """
    try:
        given = np.asarray(value)
        # NumPy would take "1", True and the real part of 1 + 2j for numbers.
        if given.dtype.kind not in "iufO" or (given.dtype.kind == "O" and _holds_text_or_truth(given)):
            raise TypeError(f"not numbers: {given.dtype}")
        array = read_only(given)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name}: expected numbers of shape {_describe(shape)}, got {reprlib.repr(value)}") from error
    fits = array.ndim == len(shape) and all(
        want is None or have == want for have, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        raise InputError(f"{name}: shape {array.shape} is not {_describe(shape)}")
    valid = ~np.isinf(array) if allow_nan else np.isfinite(array)
    if np.count_nonzero(valid) < valid.size:
        index = tuple(int(i) for i in np.argwhere(~valid)[0])
        where = f"[{', '.join(map(str, index))}]" if index else ""
        suffix = f" {unit}" if unit else ""
        raise InputError(f"{name}{where} = {float(array[index])}{suffix} is not a finite number")
    return array


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
        raise InputError(f"{name}: expected a number{suffix and ' in' + suffix}, got {value!r}")
    number = float(checked_array(name, value, (), unit=unit))  # type: ignore[arg-type]
    if above is not None and not number > above:
        raise InputError(f"{name} = {number:g}{suffix} must be greater than {above:g}{suffix}")
    if at_least is not None and not number >= at_least:
        raise InputError(f"{name} = {number:g}{suffix} must be at least {at_least:g}{suffix}")
    if at_most is not None and not number <= at_most:
        raise InputError(f"{name} = {number:g}{suffix} must be at most {at_most:g}{suffix}")
    return number


def checked_times(name: str, value: ArrayLike, count: int | None = None) -> Array:
    """Return strictly increasing times in s; a message names the first pair that is not."""
    times = checked_array(name, value, (count,), unit="s")
    increasing = times[1:] > times[:-1]
    if not increasing.all():
        k = int(np.argmin(increasing))
        raise InputError(
            f"{name}: must increase strictly, but {name}[{k}] = {times[k]:.12g} s is followed by {times[k + 1]:.12g} s"
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


def _describe(shape: Sequence[int | None]) -> str:
    free = iter("nmk")  # (n, n) would ask for a square
    lengths = ", ".join(next(free) if length is None else str(length) for length in shape)
    return f"({lengths}{',' if len(shape) == 1 else ''})"
