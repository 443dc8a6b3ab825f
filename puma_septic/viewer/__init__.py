"""The replay: motions shown in three dimensions, live in a browser, in a notebook, or as one file."""

from puma_septic.viewer._live import Replay, replay, replay_html, write_replay

__all__ = ["Replay", "replay", "replay_html", "write_replay"]
