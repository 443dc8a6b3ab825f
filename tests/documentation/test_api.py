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
