"""How tests start other processes."""

from __future__ import annotations

import signal


def heeding_ctrl_c() -> None:
    """For `preexec_fn`: a run that was started in the background hands on to its children that they ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
