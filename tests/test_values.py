"""What all public values promise: they travel between processes, are copied, and are not written to."""

from __future__ import annotations

import copy
import importlib
import inspect
import multiprocessing
import pickle
import pkgutil
import re
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields, is_dataclass
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from helpers.public_values import ONE_OF_EACH, SLOW, VALUES

import puma_septic as ps
from puma_septic.ros import Fault
from puma_septic.validation import FrozenMap, freeze_fields, frozen

# A running server cannot be in two processes.
STAYS = "Replay"
# One of each exception that the package raises, and what it must still say after a journey.
ERRORS: dict[str, Callable[[], ps.PumaSepticError]] = {
    "PumaSepticError": lambda: ps.PumaSepticError("any"),
    "InputError": lambda: ps.InputError("mass = -1 kg"),
    "ModelError": lambda: ps.ModelError("arm.urdf, line 3"),
    "NoSolution": lambda: ps.NoSolution("out of reach", residual=0.25, q=np.arange(6.0)),
    "JointTrajectoryError": lambda: ps.JointTrajectoryError(
        "a.yaml", [Fault(code="bad_value", message="points[0]: no number")]
    ),
}
FAR = np.eye(4) + np.eye(4, k=3) * 9.0
JOURNEYS: dict[str, Callable[[Any], Any]] = {
    "pickle 2": lambda value: pickle.loads(pickle.dumps(value, 2)),
    "pickle 5": lambda value: pickle.loads(pickle.dumps(value, 5)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def told(value: Any) -> Any:
    """All that is compared of a value that has travelled."""
    return [repr(value), value.to_dict() if hasattr(value, "to_dict") else None]


def returned(value: Any) -> Any:
    """What a worker does."""
    return value


def raised(value: Exception) -> None:
    raise value


def solve(_: int) -> None:
    """A pose out of reach."""
    ps.inverse_kinematics(ps.load_robot(), FAR)


# ---- travelling


@pytest.mark.parametrize("journey", JOURNEYS)
@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_a_value_travels(name: str, journey: str) -> None:
    """Of 36 public values 20 could not be pickled, once robots held mappings that cannot be written."""
    if name == STAYS:
        pytest.skip("a running server")
    value = VALUES[name]()
    assert told(JOURNEYS[journey](value)) == told(value)


@pytest.mark.parametrize("journey", JOURNEYS)
@pytest.mark.parametrize("name", ERRORS)
def test_an_error_travels(name: str, journey: str) -> None:
    error = ERRORS[name]()
    there = JOURNEYS[journey](error)
    assert type(there) is type(error)
    assert str(there) == str(error)
    assert repr(vars(there)) == repr(vars(error))


def test_every_error_of_the_package_is_among_them() -> None:
    for module in pkgutil.walk_packages(ps.__path__, "puma_septic."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    found, pending = set(), [ps.PumaSepticError]
    while pending:
        found.add(pending[-1].__name__)
        pending += pending.pop().__subclasses__()
    assert found == set(ERRORS)
    public = {name for name in ps.__all__ if inspect.isclass(getattr(ps, name))}
    assert public == set(VALUES) | {name for name in ERRORS if name in ps.__all__}


@pytest.mark.slow
@pytest.mark.parametrize("method", ["spawn", "fork"])
def test_processes_exchange_values_and_errors(method: str) -> None:
    """One pose out of reach made `multiprocessing.Pool` wait for ever, and broke the pool of concurrent.futures."""
    values = [make() for name, make in VALUES.items() if name not in SLOW]
    with ProcessPoolExecutor(1, multiprocessing.get_context(method)) as pool:
        for value, back in zip(values, pool.map(returned, values), strict=True):
            assert told(back) == told(value)
        for make in ERRORS.values():
            with pytest.raises(type(make()), match=re.escape(str(make()))):
                pool.submit(raised, make()).result(timeout=60)
        with pytest.raises(ps.NoSolution, match="out of reach") as caught:
            pool.submit(solve, 0).result(timeout=60)
    assert caught.value.residual > 1
    assert np.shape(caught.value.q) == (6,)


# ---- nobody writes to them


def parts(value: Any, name: str, seen: set[int], depth: int = 0) -> Iterator[tuple[str, Any]]:
    """A value, and all that can be reached from it by public names: with its path."""
    if id(value) in seen or depth > 8:
        return
    seen.add(id(value))
    yield name, value
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from parts(item, f"{name}[{key!r}]", seen, depth + 1)
    elif isinstance(value, (tuple, list)):
        for k, item in enumerate(value[:3]):
            yield from parts(item, f"{name}[{k}]", seen, depth + 1)
    elif type(value).__module__.startswith("puma_septic"):
        own = {field.name for field in fields(value)} if is_dataclass(value) else set()
        for attribute in sorted(own | {one for one, _ in inspect.getmembers(type(value), _is_computed)}):
            if not attribute.startswith(("_", "model_")):  # model_: pydantic's own
                try:
                    item = getattr(value, attribute)
                except ps.InputError:  # asked for what is not known
                    continue
                yield from parts(item, f"{name}.{attribute}", seen, depth + 1)


def _is_computed(member: object) -> bool:
    return isinstance(member, property) or type(member).__name__ == "cached_property"


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_nothing_in_a_value_can_be_written_to(name: str) -> None:
    """116 arrays and dictionaries could: a sorted `utilisation` made a selection contradict itself."""
    value = VALUES[name]()
    found = list(parts(value, name, set()))
    writable = [path for path, item in found if isinstance(item, np.ndarray) and item.flags.writeable]
    changeable = [path for path, item in found if isinstance(item, (dict, list, set, bytearray))]
    assert (writable, changeable) == ([], [])
    if name == STAYS:
        value.close()


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_no_attribute_can_be_set(name: str) -> None:
    value = VALUES[name]()
    for attribute in ("anything", *([fields(value)[0].name] if is_dataclass(value) else [])):
        with pytest.raises((AttributeError, TypeError, ValueError)):
            setattr(value, attribute, 1)
    if name == STAYS:
        value.close()


def test_a_frozen_map_is_a_copy_without_writers() -> None:
    given = {"a": 1}
    made = FrozenMap(given)
    given["a"] = 2
    assert (dict(made), len(made), repr(made)) == ({"a": 1}, 1, "{'a': 1}")
    assert made == {"a": 1}
    with pytest.raises(TypeError):
        made["a"] = 3  # type: ignore[index]
    with pytest.raises(AttributeError):
        made.clear()  # type: ignore[attr-defined]


# ---- what is given is copied


ZERO = np.array(0.25)
NUMBERS = [ZERO, Decimal("0.25"), np.float32(0.25)]
TAKES_A_NUMBER: dict[str, Callable[[Any], Any]] = {
    "Actuator.rotor_inertia": lambda x: ps.Actuator(gear_ratio=100.0, rotor_inertia=x).rotor_inertia,
    "Actuator.gear_ratio": lambda x: ps.Actuator(gear_ratio=x).gear_ratio,
    "Controller.delay": lambda x: ps.Controller(law="pd", delay=x).delay,
    "Drive.bus_voltage": lambda x: ps.Drive(bus_voltage=x).bus_voltage,
    "Drivetrain.altitude": lambda x: ps.Drivetrain(altitude=x).altitude,
    "Drivetrain.ambient_celsius": lambda x: ps.Drivetrain(ambient_celsius=x).ambient_celsius,
    "Dwell.duration": lambda x: ps.Dwell(x).duration,
    "Friction.viscous": lambda x: ps.Friction(viscous=x).viscous,
    "Gearbox.ratio": lambda x: ps.Gearbox(ratio=x).ratio,
    "Gearbox.bearing_offset": lambda x: ps.Gearbox(ratio=100.0, bearing_offset=x).bearing_offset,
    "LinearStage.efficiency": lambda x: ps.LinearStage(
        kind="screw", travel_per_turn=0.01, efficiency=x
    ).efficiency,
    "Motor.copper_coefficient": lambda x: ps.Motor(copper_coefficient=x).copper_coefficient,
    "Motor.peak_torque": lambda x: ps.Motor(peak_torque=x).peak_torque,
    "Payload.mass": lambda x: ps.Payload(x).mass,
    "Supply.bus_voltage": lambda x: ps.Supply(bus_voltage=x).bus_voltage,
}  # fmt: skip


@pytest.mark.parametrize("number", NUMBERS, ids=[type(one).__name__ for one in NUMBERS])
@pytest.mark.parametrize("name", TAKES_A_NUMBER)
def test_a_number_becomes_a_float(name: str, number: Any) -> None:
    """A mass given as an array of no dimensions changed with it; one of type Decimal was Boost's ArgumentError."""
    kept = TAKES_A_NUMBER[name](number)
    assert type(kept) is float
    assert kept == 0.25


@pytest.mark.parametrize("value", ["0.25", None, b"1", 1j, True, [0.25], np.ma.masked, 10**400, {}], ids=repr)
@pytest.mark.parametrize("name", TAKES_A_NUMBER)
def test_what_is_no_number_is_refused(name: str, value: Any) -> None:
    with pytest.raises(ps.InputError, match=r"expected (a number|numbers)|not a finite number|is not \(\)|masked"):
        TAKES_A_NUMBER[name](value)


def test_arrays_are_copied() -> None:
    given = np.zeros((2, 6))
    given[1] = 0.5
    move = ps.quintic_segments(given, [0.0, 1.0])
    given[1] = 9.0
    assert move.points[1].tolist() == [0.5] * 6


def test_only_what_has_just_been_made_is_frozen() -> None:
    array = np.zeros(2)
    assert frozen(array) is array
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1.0
    assert callable(freeze_fields)
