"""replay: look at motions in a browser, in a notebook, or in a file."""

from __future__ import annotations

import os
import sys
import webbrowser
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from types import TracebackType
from typing import final

from puma_septic.assessment import Assessment, assess
from puma_septic.document import one_line
from puma_septic.errors import InputError
from puma_septic.motion import Motion
from puma_septic.outputs import write_file
from puma_septic.validation import checked_flag, checked_kind, checked_list, checked_texts
from puma_septic.viewer._page import page_html
from puma_septic.viewer._scene import shown
from puma_septic.viewer._server import PageServer, serve_page

__all__ = ["Replay", "replay", "replay_html", "write_replay"]

Movable = Motion | Assessment


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Replay:
    """A replay that is being served to browsers on this machine; made by `replay`.

    It ends with `close`, with the ``with`` statement that holds it, or with the process. As the last value of a
    notebook's cell it shows itself in place.

    Attributes
    ----------
    html : str
        The whole page, which needs no server: the text that `write_replay` writes.
    browser_opened : bool
        Whether a browser was asked to show it; otherwise open `url` yourself.
    """

    html: str
    browser_opened: bool
    _server: PageServer

    @property
    def url(self) -> str:
        """Where the page is, for a browser on this machine."""
        return self._server.url

    def wait(self) -> None:
        """Keep serving until Ctrl-C: what a script does last."""
        self._server.wait()

    def close(self) -> None:
        """Stop serving; a page that is open stays usable."""
        self._server.close()

    def __enter__(self) -> Replay:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _repr_html_(self) -> str:
        """A frame that holds the page itself, so that a saved notebook still plays; kept apart from the notebook."""
        return (
            f'<iframe srcdoc="{escape(self.html)}" sandbox="allow-scripts allow-downloads" allow="fullscreen"'
            ' title="replay" style="width:100%;height:640px;border:0"></iframe>'
        )

    def __repr__(self) -> str:
        return one_line("Replay", self._facts())

    def _facts(self) -> dict[str, object]:
        return {"url": self.url, "size": f"{len(self.html) / 1e6:z.1f} MB"}


def replay(
    what: Movable | Sequence[Movable],
    *,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    point_names: Sequence[str] = (),
    open_browser: bool | None = None,
    port: int | None = None,
) -> Replay:
    """Show one motion, or several at once, as an arm that moves.

    The first motion is the solid arm, its links coloured by torque utilisation; further ones are ghosts. Drawn as well:
    the tool's path in the colour of its motion, thicker where it is faster, via points, payload, and where limits break
    and postures are singular. The page has play, pause, speed and a time line, views and a camera that follows the
    tool, and it writes pictures and video; it moves at true speed.

    Parameters
    ----------
    what : Motion, Assessment, or a sequence of them
    labels : sequence of str, optional
        One for each motion; the profiles' names by default.
    title : str, optional
        Heading of the page; the robot's name by default.
    point_names : sequence of str
        Names of the via points; numbers by default.
    open_browser : bool, optional
        Ask the system's browser to show it. By default so, but not in a notebook, where the value shows itself.
    port : int, optional
        Wanted; another is chosen where it is taken. By default the system chooses.

    Returns
    -------
    Replay
        With the address as ``url``. It is served from this process, to this machine only: a script ends with
        ``replay(...).wait()``.

    Raises
    ------
    InputError
        For nothing to show, labels that are too few or many, or an invalid port.
    ModelError
        For a mesh that cannot be read or drawn, with its file.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> motion = ps.compute_motion(ps.load_robot(), move)
    >>> with ps.replay(motion, open_browser=False) as page:
    ...     print(page.url)
    http://127.0.0.1:.../
    """
    html = replay_html(what, labels=labels, title=title, point_names=point_names)
    server = serve_page(html, port=port)
    wanted = "ipykernel" not in sys.modules if open_browser is None else checked_flag("open_browser", open_browser)
    return Replay(html=html, browser_opened=wanted and _open(server.url), _server=server)


def replay_html(
    what: Movable | Sequence[Movable],
    *,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    point_names: Sequence[str] = (),
    has_panel: bool = True,
) -> str:
    """The replay as one HTML page, which works from disk and asks for nothing from the network; see `replay`.

    A page that holds it in a frame sets its time by ``frame.contentWindow.postMessage({replay: "seek", time: 1.5},
    "*")`` and is told its own by messages ``{replay: "time", time: ...}``; "play" and "pause" run it, ``{replay:
    "show", motion: 1, shown: false}`` hides a motion. Without its panel it is for such a page.

    Parameters
    ----------
    what, labels, title
        As of `replay`.
    point_names : sequence of str
        Names of the via points, such as those of a task; numbers by default.
    has_panel : bool
        Whether numbers, legend and time line stand beside and below the scene.

    Returns
    -------
    str

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> html = replay_html(ps.compute_motion(ps.load_robot(), move))
    >>> html[:15], "://" in html, len(html) < 1_000_000
    ('<!DOCTYPE html>', False, True)
    """
    group = [what] if isinstance(what, Motion | Assessment) else list(checked_list("replay", what))
    if not group:
        raise InputError("replay: there is no motion to show")
    for one in group:
        if not isinstance(one, Motion | Assessment):
            raise InputError(f"replay shows motions and assessments, not {type(one).__name__}: {one!r}")
    assessments = [one if isinstance(one, Assessment) else assess(one) for one in group]
    names = _labels([one.motion.trajectory.profile for one in assessments], labels)
    robots = dict.fromkeys(one.motion.robot.name for one in assessments)
    heading = ", ".join(robots) if title is None else checked_kind("title", title, str)
    point_names = checked_texts("point_names", point_names)
    motions = [shown(one, name) for one, name in zip(assessments, names, strict=True)]
    return page_html(motions, heading, point_names=point_names, has_panel=has_panel)


def write_replay(
    path: str | Path,
    what: Movable | Sequence[Movable],
    *,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    point_names: Sequence[str] = (),
    overwrite: bool = False,
) -> Path:
    """Write the replay as one HTML file, to keep or to send, whole or not at all; see `replay_html`.

    With `overwrite` it may replace a file.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        Where the file exists and may not be replaced, or cannot be written, with the reason; and as `replay`.
    """
    html = replay_html(what, labels=labels, title=title, point_names=point_names)
    return write_file(path, html, overwrite=overwrite)


def _labels(profiles: Sequence[str], given: Sequence[str] | None) -> list[str]:
    """The given labels, or the profiles' names, numbered where one comes twice."""
    if given is not None:
        if isinstance(given, str) or len(checked_list("labels", given)) != len(profiles):
            count = "a single text" if isinstance(given, str) else str(len(given))
            raise InputError(f"labels: {count} for {len(profiles)} motions; give one for each")
        return [str(label) for label in given]
    counts, seen, names = Counter(profiles), Counter[str](), []
    for profile in profiles:
        seen[profile] += 1
        names.append(profile if counts[profile] == 1 else f"{profile} {seen[profile]}")
    return names


def _open(url: str) -> bool:
    """Whether a browser took the address.

    Without a screen none is started: one that draws with letters would take over the terminal.
    """
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    try:
        return webbrowser.open(url, new=2)
    except (webbrowser.Error, OSError):
        return False
