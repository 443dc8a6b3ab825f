"""The pages of the API have every public name, and the site's contents every page."""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from types import ModuleType
from typing import Any

import pytest
from helpers.places import DOCS

import puma_septic as ps

API = "\n".join(path.read_text(encoding="utf-8") for path in sorted((DOCS / "api").glob("*.md")))
_MODULE = re.compile(r"^\.\. automodule:: (\S+)\n((?:   :.*\n)*)", re.MULTILINE)
_FUNCTION = re.compile(r"^\.\. autofunction:: (\S+)\.(\w+)$", re.MULTILINE)


def _documented() -> list[Any]:
    """What autodoc finds: modules, and the members that their directives ask for."""
    found: list[Any] = [getattr(import_module(module), name) for module, name in _FUNCTION.findall(API)]
    for name, options in _MODULE.findall(API):
        module = import_module(name)
        asked = re.search(r":members:(.*)", options)
        assert asked is not None, f"{name}: no members"
        chosen = asked[1].replace(",", " ").split() or module.__all__
        members = [getattr(module, member) for member in chosen]
        found.append(module)
        # Without the option autodoc leaves out what a room only hands on.
        found += [one for one in members if ":imported-members:" in options or _home(one) == name]
    return found


def _home(value: Any) -> str | None:
    return getattr(value, "__module__", None)


@pytest.mark.parametrize("name", [name for name in ps.__all__ if name != "__version__"])
def test_every_public_name_has_its_place_in_the_api(name: str) -> None:
    value = getattr(ps, name)
    assert any(one is value for one in _documented()), f"add {name} to a page of docs/api"


def test_rooms_hand_on_what_their_page_shows() -> None:
    """`:imported-members:` follows `__all__`; a module without it would show all that it imports."""
    names = [name for name, _ in _MODULE.findall(API)]
    assert len(names) == len(set(names)), "a module on two pages"
    for name in names:
        module = import_module(name)
        assert isinstance(module, ModuleType)
        assert hasattr(module, "__all__"), name


def test_every_page_is_in_the_contents() -> None:
    """Each once, by name: a glob once took in, or left out, whatever a page's first letter said."""
    contents = re.compile(r"```\{toctree\}\n(.*?)```", re.DOTALL)
    listed = []
    for index in (DOCS / "index.md", DOCS / "api" / "index.md"):
        for block in contents.findall(index.read_text(encoding="utf-8")):
            lines = [line for line in block.splitlines() if line and not line.startswith(":")]
            listed += [(index.parent / line).relative_to(DOCS).as_posix() for line in lines]
    pages = {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    assert sorted(listed) == sorted(pages - {"index"})


@pytest.mark.parametrize("name", [name for name in ps.__all__ if inspect.isfunction(getattr(ps, name))])
def test_every_public_function_says_what_it_returns(name: str) -> None:
    function = getattr(ps, name)
    returns_nothing = inspect.signature(function).return_annotation in (None, "None")
    assert returns_nothing or "\nReturns\n-------\n" in (inspect.getdoc(function) or "")


def _callables() -> dict[str, Any]:
    """What users call: public functions and classes, those of public rooms too."""
    rooms = {"ps": ps} | {name: getattr(ps, name) for name in ps.__all__ if inspect.ismodule(getattr(ps, name))}
    members = {f"{room}.{name}": getattr(module, name) for room, module in rooms.items() for name in module.__all__}
    return {name: one for name, one in members.items() if inspect.isfunction(one) or inspect.isclass(one)}


@pytest.mark.parametrize("name", [name for name, one in _callables().items() if not hasattr(one, "_fields")])
def test_options_are_told_by_name(name: str) -> None:
    """At most three arguments by place, of which a state (q, v, a or tau) is one; the rest by name alone.

    In a neighbouring project a positional `limits` landed in a boolean, and the robot ran without limits.
    """
    parameters = inspect.signature(_callables()[name]).parameters.values()
    by_place = [one for one in parameters if one.kind not in (one.KEYWORD_ONLY, one.VAR_KEYWORD, one.VAR_POSITIONAL)]
    state = [one for one in by_place if one.name in ("q", "v", "a", "tau")]
    assert len(by_place) - max(len(state) - 1, 0) <= 3
    assert [one.name for one in by_place if one.kind is one.POSITIONAL_ONLY or isinstance(one.default, bool)] == []
