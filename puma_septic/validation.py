"""Arrays and numbers at the door: float64, the right shape, finite, read-only; mappings that stay as they are."""

from __future__ import annotations

import reprlib
from collections import deque
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
    "checked_direction",
    "checked_each",
    "checked_flag",
    "checked_kind",
    "checked_list",
    "checked_number",
    "checked_rng",
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
# What none that must be above 0 falls below, nor the time between two instants: the seventh power of its inverse is
# still finite.
_SMALLEST: Final = 1e-30
# What is certainly a number, truth values apart, and how deep lists are looked into; no array of ours is so deep.
_NUMBERS: Final = (int, float, np.integer, np.floating)
_DEEPEST: Final = 16
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
    labels: Sequence[str] = (),
    allow_nan: bool = False,
    largest: float = LARGEST,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    remedy: str = "",
) -> Array:
    """Return `value` as a read-only float64 copy of the given shape and within the given bounds.

    Parameters
    ----------
    name : str
        How the message calls the argument.
    shape : sequence of int or None, or None
        Expected shape; None leaves a length free, or all of it.
    unit : str
        Unit named in the message.
    labels : sequence of str
        What the message calls the places of a row, such as "joint 'elbow'", in place of their index.
    allow_nan : bool
        Accept NaN as "unknown" (limits), whatever the bounds; infinities are refused in any case.
    largest : float
        Magnitude up to which a number is accepted.
    above, at_least, at_most : float
        Bounds of every number, the first exclusive; above 0 the least is 1 / LARGEST.
    remedy : str
        What a message of a bound ends with.

    Raises
    ------
    InputError
        With name, offending index and value, and what would be valid.
    """
    array = read_only(numbers(name, value, shape))
    if shape is not None and not _fits(array.shape, shape):
        raise InputError(f"{name}: shape {array.shape} is not {_describe(shape)}")
    valid = ~np.isinf(array) if allow_nan else np.abs(array) <= largest
    suffix = f" {unit}" if unit else ""
    if np.count_nonzero(valid) < valid.size:
        k = int(np.argmin(valid))
        number = float(array.flat[k])
        why = f"beyond {largest:g}, as no quantity of an arm is" if np.isfinite(number) else "not a finite number"
        raise InputError(f"{_place(name, array, k, labels)} = {number}{suffix} is {why}")
    for words, bound, k in _beyond(array, above, at_least, at_most):
        where = f"{_place(name, array, k, labels)} = {array.flat[k]:g}{suffix}"
        raise InputError(f"{where} must be {words} {bound:g}{suffix}{remedy}")
    return array


def checked_each(name: str, value: ArrayLike, count: int, **rules: Any) -> Array:
    """Return one number for all, or one for each, with the shape (count,); the rules are those of `checked_array`."""
    if n_dimensions(value) == 0:
        return np.broadcast_to(checked_array(name, value, (), **rules), (count,))
    return checked_array(name, value, (count,), **rules)


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
    flaw = _flaw(value)
    if flaw == "masked":
        raise InputError(f"{name}: some of its numbers are masked; leave them out, or fill them")
    try:
        if flaw or value is None:
            raise TypeError("NumPy would make numbers of it")
        given = np.asarray(value)
        if given.dtype.kind not in "iufO" or (given.dtype.kind == "O" and _flaw(given)):
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
    if _flaw(value) == "masked":
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
        wanted = "a text" if kind is str else f"{kinds}(...)"
        raise InputError(f"{name}: expected {wanted}, got {reprlib.repr(value)}")
    return value


def checked_list(name: str, value: Iterable[Kind]) -> tuple[Kind, ...]:
    """Return what can be gone through as a tuple; a text is no list of its letters."""
    try:
        if not isinstance(value, (str, bytes)):
            return tuple(value)
    except TypeError:  # an array without dimensions calls itself iterable
        pass
    raise InputError(f"{name}: expected a list, got {reprlib.repr(value)}")


def checked_texts(name: str, value: Iterable[str] | None) -> tuple[str, ...]:
    """Return texts as a tuple, empty for None; one text is no list of its letters."""
    texts = () if value is None else checked_list(name, value)
    if not all(isinstance(one, str) for one in texts):
        raise InputError(f"{name}: expected a list of texts, got {reprlib.repr(value)}")
    return texts


def checked_flag(name: str, value: bool) -> bool:
    """Return True or False; a text such as "no" would be true."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(f"{name} = {reprlib.repr(value)}: expected True or False")
    return bool(value)


def checked_rng(rng: np.random.Generator | None) -> np.random.Generator:
    """Return the generator, for None a new one, so that equal calls give equal results."""
    return np.random.default_rng(0) if rng is None else checked_kind("rng", rng, np.random.Generator)


def checked_whole(name: str, value: Any, *, at_least: int | None = None, at_most: int | None = None) -> int:
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
    if isinstance(value, (bool, np.bool_, str)) or value is None:
        raise InputError(f"{name}: expected a number{unit and ' in ' + unit}, got {reprlib.repr(value)}")
    bounds = {"above": above, "at_least": at_least, "at_most": at_most}
    return float(checked_array(name, value, (), unit=unit, **bounds))  # type: ignore[arg-type]


def checked_times(name: str, value: ArrayLike, count: int | None = None) -> Array:
    """Return strictly increasing times in s; a message names the first pair that is not."""
    times = checked_array(name, value, (count,), unit="s")
    steps = times[1:] - times[:-1]
    if not (steps > 0).all():
        k = int(np.argmin(steps > 0))
        raise InputError(
            f"{name}: must increase strictly, but {name}[{k}] = {times[k]:.12g} s is followed by {times[k + 1]:.12g} s"
        )
    if not (steps >= _SMALLEST).all():
        k = int(np.argmin(steps))
        raise InputError(
            f"{name}[{k}] = {times[k]:.12g} s and {name}[{k + 1}] = {times[k + 1]:.12g} s are too close to each other"
        )
    return times


def checked_direction(name: str, value: ArrayLike) -> Array:
    """Return the unit vector along three numbers."""
    vector = checked_array(name, value, (3,))
    if np.abs(vector).max() < _SMALLEST:  # its square would be 0
        raise InputError(f"{name}: expected three numbers, not all 0, got {vector.tolist()}")
    return np.asarray(vector / np.linalg.norm(vector))


def checked_choice(name: str, value: str, valid: Iterable[str]) -> str:
    """Return `value` if it is one of the valid names, which the message lists otherwise."""
    names = list(valid)
    if not (isinstance(value, str) and value in names):  # an array is equal to many things at once
        meant = did_you_mean([value], names) if isinstance(value, str) else ""
        raise InputError(f"unknown {name} {reprlib.repr(value)}; valid: {', '.join(map(repr, names))}{meant}")
    return value


def _flaw(value: object, depth: int = 0) -> str:
    """What would be lost of a value if NumPy made numbers of it: "masked", or "no number"; "" of sound ones."""
    if isinstance(value, np.ndarray):
        if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
            return "masked"
        if value.dtype.kind != "O":
            return "" if value.dtype.kind in "iuf" else "no number"
        value = value.ravel().tolist()
    if not isinstance(value, (list, tuple, deque)):
        return "no number" if isinstance(value, (str, bytes, bool, np.bool_)) else ""
    if depth > _DEEPEST:
        return "no number"
    strange = {kind for kind in set(map(type, value)) if kind is bool or not issubclass(kind, _NUMBERS)}
    flaws = (_flaw(item, depth + 1) for item in value if type(item) in strange) if strange else ()
    return next(filter(None, flaws), "")


def _beyond(
    array: Array, above: float | None, at_least: float | None, at_most: float | None
) -> Iterator[tuple[str, float, int]]:
    """Every bound that is not kept, in words, and the place of what is farthest beyond it; NaN keeps all."""
    if not array.size or (above is None and at_least is None and at_most is None):
        return
    low, high = (array.item(),) * 2 if not array.ndim else (np.fmin.reduce(array, None), np.fmax.reduce(array, None))
    least = _SMALLEST if above == 0 else at_least
    if above is not None and low <= above:
        yield "greater than", above, int(np.nanargmin(array))
    if least is not None and low < least:
        yield "at least", least, int(np.nanargmin(array))
    if at_most is not None and high > at_most:
        yield "at most", at_most, int(np.nanargmax(array))


def _place(name: str, array: Array, k: int, labels: Sequence[str]) -> str:
    """How a message calls the k-th number of an array."""
    index = [int(i) for i in np.unravel_index(k, array.shape)]
    if labels and index:
        name, index = f"{labels[index[-1]]}: {name}", index[:-1]
    return f"{name}[{', '.join(map(str, index))}]" if index else name


def _fits(shape: Sequence[int], wanted: Sequence[int | None]) -> bool:
    pairs = zip(shape, wanted, strict=False)
    return len(shape) == len(wanted) and all(want is None or have == want for have, want in pairs)


def _describe(shape: Sequence[int | None]) -> str:
    free = iter("nmk")  # (n, n) would ask for a square
    lengths = ", ".join(next(free) if length is None else str(length) for length in shape)
    return f"({lengths}{',' if len(shape) == 1 else ''})"
