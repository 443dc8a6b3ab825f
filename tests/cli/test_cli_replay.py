"""``puma-septic replay``: a file, or an address until Ctrl-C."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest
from helpers.processes import heeding_ctrl_c

from puma_septic.cli import main

COMMAND = [sys.executable, "-m", "puma_septic.cli", "replay"]


def test_writes_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "replay.html"
    assert main(["replay", "paper-turned", "--profile", "lspb", "--payload", "1.5", "--html", str(target)]) == 0
    out, err = capsys.readouterr()
    assert (str(target) in out, err) == (True, "")
    html = target.read_text(encoding="utf-8")
    assert '"label":"lspb"' in html
    assert '"payload":"1.5 kg"' in html
    assert "septic" not in re.findall(r'"label":"([^"]*)"', html)


def test_a_folder_that_cannot_be_written_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", "--html", str(tmp_path / "none" / "replay.html")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert re.fullmatch(r"puma-septic: error: .*replay\.html.: cannot be written: [^\n]*\n", err)


@pytest.mark.slow
def test_serves_until_ctrl_c_on_another_port_where_one_is_taken() -> None:
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = other.getsockname()[1]
        child = subprocess.Popen([*COMMAND, "--no-browser", "--port", str(taken)], stdout=subprocess.PIPE, text=True,
                                 stderr=subprocess.PIPE, env=environment, start_new_session=True,
                                 preexec_fn=heeding_ctrl_c)  # fmt: skip
        assert child.stdout is not None
        line = child.stdout.readline()
        found = re.fullmatch(
            rf"port {taken} is taken: (http://127\.0\.0\.1:(\d+)/) \(open it in a browser .*\)\n", line
        )
        assert found is not None, line
        assert int(found[2]) != taken
        with urllib.request.urlopen(found[1], timeout=10) as page:
            assert page.read(15) == b"<!DOCTYPE html>"
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=20)
    assert (child.returncode, out, err) == (0, "replay ended\n", "")
    with pytest.raises(ProcessLookupError):
        os.killpg(child.pid, 0)
