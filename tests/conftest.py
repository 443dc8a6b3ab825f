"""What all tests share: the robot, seeded randomness, the reference numbers, hypothesis profiles."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

# The matrices here are small: on a busy machine, threads that wait for each other cost more than they save.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pytest
from helpers.places import REFERENCE
from helpers.schemas import undocumented
from hypothesis import settings

import puma_septic as ps
from puma_septic import document
from puma_septic.task import ResolvedTask, assess_task, load_task, resolve_task

# A run finds the same examples every time, on any machine, however slow; to look for new ones, and ten times as many:
# python -m pytest --hypothesis-profile explore -m "hypothesis and not browser and not study"
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, print_blob=True)
settings.load_profile("repeatable")


def pytest_addoption(parser: pytest.Parser) -> None:
    """The switch that takes what is written today for right."""
    parser.addoption("--update-golden", action="store_true", help="rewrite the files that tests/golden compares with")


@pytest.hookimpl(trylast=True)  # hypothesis marks its tests first
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Function]) -> None:
    """Ten times the examples that each test asks for, which no profile can say; some tests share their function."""
    if config.getoption("--hypothesis-profile") == "explore":
        for test in {item.function for item in items if item.get_closest_marker("hypothesis")}:
            asked = test._hypothesis_internal_use_settings
            test._hypothesis_internal_use_settings = settings(asked, max_examples=10 * asked.max_examples)


@pytest.fixture(scope="session")
def puma() -> ps.Robot:
    """The PUMA 560 as `load_robot()` gives it; immutable, so one is enough."""
    return ps.load_robot()


@pytest.fixture(scope="session")
def paper_task() -> tuple[ResolvedTask, tuple[ps.Assessment, ...]]:
    """The built-in task "paper", and its 9 s move with each of its three profiles."""
    resolved = resolve_task(load_task("paper"))
    return resolved, assess_task(resolved)


@pytest.fixture(scope="session")
def paper(paper_task: tuple[ResolvedTask, tuple[ps.Assessment, ...]]) -> tuple[ps.Assessment, ...]:
    """The paper's 9 s move with each of its three profiles."""
    return paper_task[1]


@pytest.fixture
def rng() -> np.random.Generator:
    """The same random numbers in each test."""
    return np.random.default_rng(560)


@pytest.fixture(scope="session")
def reference() -> Path:
    """The folder of numbers taken from elsewhere, each with its source."""
    return REFERENCE


@pytest.fixture(autouse=True)
def _plain_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Text is as wide as a page and without colours, whatever the terminal that tests run in."""
    for name in ("COLUMNS", "NO_COLOR", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture(autouse=True)
def _documented(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Each document that a test writes as JSON is held against docs/schemas.json."""
    faults: list[str] = []

    def dumps(value: Any, **options: Any) -> str:
        # Told at the end: an error that was raised here would be one of the command line's.
        if "schema" in value:
            faults.extend(undocumented(json.loads(json.dumps(value))))
        return json.dumps(value, **options)

    monkeypatch.setattr(document, "json", SimpleNamespace(dumps=dumps))
    yield
    assert not faults, "docs/schemas.json: " + "; ".join(faults[:5])


# ---- a real browser, for the tests that are marked so

# No look at the network of its own; drawing in software, as there may be no graphics card.
FLAGS = [
    "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--disable-quic", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
]  # fmt: skip


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Debian's chromium or another one, else the one that playwright brought."""
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    # Loaded here, as all other tests do without it.
    with import_module("playwright.sync_api").sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=found, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def complaints() -> list[str]:
    """What the page has thrown, logged as an error or asked in a dialog."""
    return []


@pytest.fixture
def page(browser: Any, complaints: list[str]) -> Iterator[Any]:
    """A page that stands still, cannot reach any network, and whose every complaint fails the test."""
    context = browser.new_context(viewport={"width": 1100, "height": 700}, reduced_motion="reduce", offline=True)
    opened = context.new_page()
    opened.on("pageerror", lambda error: complaints.append(f"{error}\n{error.stack}"))
    opened.on("console", lambda line: complaints.append(line.text) if line.type == "error" else None)
    opened.on("dialog", lambda dialog: (complaints.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    yield opened
    context.close()
    assert complaints == []
