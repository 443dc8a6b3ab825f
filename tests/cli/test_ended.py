"""Commands that are ended by a signal, or that cannot be heard: nothing half written, a code that is no verdict."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest

from puma_septic.cli import main

COMMAND = [sys.executable, "-m", "puma_septic.cli"]


def _heeding() -> None:
    """Signals as a shell in the foreground gives them to its child, whatever the tests run under."""
    for one in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(one, signal.SIG_DFL if one != signal.SIGINT else signal.default_int_handler)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)], ids=["INT", "TERM", "HUP"]
)
def test_a_signal_leaves_nothing_half_written(number: signal.Signals, code: int, tmp_path: Path) -> None:
    """SIGTERM and SIGHUP killed it where it stood, and a hidden folder stayed for good."""
    command = [*COMMAND, "size", "paper", "--out", str(tmp_path / "result")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=_heeding) as child:
        deadline = time.monotonic() + 60
        while not list(tmp_path.iterdir()) and time.monotonic() < deadline:
            time.sleep(0.005)
        child.send_signal(number)
        _, err = child.communicate(timeout=60)
    # Where Ctrl-C came while Python ran code from a string, as it does for dataclasses, CPython ends by the signal
    # itself however it was handled; a shell shows 130 for both.
    assert child.returncode in ((code, -number) if number == signal.SIGINT else (code,))
    assert list(tmp_path.iterdir()) == []
    assert b"Traceback" not in err


def test_a_signal_is_heeded_inside_and_left_to_others_outside(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(60)

    monkeypatch.setattr("puma_septic.cli._profiles.run", hang)
    before = signal.getsignal(signal.SIGTERM)
    assert before is signal.SIG_DFL
    assert main(["profiles"]) == 143
    assert signal.getsignal(signal.SIGTERM) is before


def test_a_signal_that_somebody_else_heeds_stays_theirs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under nohup a hang-up is ignored; a program that calls `main` may have handlers of its own."""
    seen: list[object] = []
    monkeypatch.setattr(
        "puma_septic.cli._profiles.run", lambda _: seen.append(signal.getsignal(signal.SIGHUP)) or 1 / 0
    )
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert main(["profiles"]) == 70
    finally:
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
    assert seen == [signal.SIG_IGN]


def test_in_another_thread_signals_are_nobody_s_business() -> None:
    codes: list[int] = []
    thread = threading.Thread(target=lambda: codes.append(main(["profiles", "--format", "csv"])))
    thread.start()
    thread.join()
    assert codes == [0]


# ---- streams


@pytest.mark.slow
@pytest.mark.parametrize(
    ("typed", "redirected", "code", "told"),
    [
        ("profiles", ">&-", 2, "the standard output is closed"),
        ("profiles", "> /dev/full", 2, "No space left on device"),
        ("profiles", "<&-", 0, ""),
        ("assess none.yaml", "2>&-", 2, ""),
        ("assess none.yaml", "2> /dev/full", 2, ""),
        ("assess --bogus", "2>&-", 2, ""),
        ("profiles", "| head -1 > /dev/null", 0, ""),
    ],
)
def test_streams_that_are_closed_or_full(typed: str, redirected: str, code: int, told: str, tmp_path: Path) -> None:
    """A closed output was an AttributeError, a full one an OSError, and both the code of a broken limit."""
    line = f"set -o pipefail; {sys.executable} -m puma_septic.cli {typed} {redirected}"
    run = subprocess.run(["bash", "-c", line], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == code
    assert told in run.stderr
    assert "Traceback" not in run.stderr


# ---- the other package called pinocchio


@pytest.mark.slow
def test_the_other_pinocchio_is_named_with_its_remedy(tmp_path: Path) -> None:
    """The package of this name on PyPI is something else: "module 'pinocchio' has no attribute 'buildModelFromXML'"."""
    (tmp_path / "pinocchio").mkdir()
    (tmp_path / "pinocchio" / "__init__.py").write_text("")
    code = textwrap.dedent("""\
        import sys
        sys.path.insert(0, sys.argv[1])
        from puma_septic.cli import main
        raise SystemExit(main(["assess", "paper-turned"]))
        """)
    run = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert "is another package called pinocchio; Pinocchio is the package pin: python -m pip uninstall" in run.stderr
