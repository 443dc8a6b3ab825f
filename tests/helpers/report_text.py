"""What a reader reads in a report: its headings, tables, captions and sentences, without pictures and scripts."""

from __future__ import annotations

from html.parser import HTMLParser

_LEFT_OUT = ("svg", "script", "style", "iframe", "noscript", "pre", "nav")
_LINES = ("h1", "h2", "h3", "h4", "p", "li", "caption", "tr", "summary")


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []
        self.words: list[str] = []
        self.hidden = 0
        self.start = ""

    def handle_starttag(self, tag: str, _attributes: list[tuple[str, str | None]]) -> None:
        if tag in _LEFT_OUT:
            self.hidden += 1
        elif tag in _LINES:
            self.end_line()
            self.start = tag
        elif tag in ("td", "th"):
            self.words.append("|")

    def handle_endtag(self, tag: str) -> None:
        if tag in _LEFT_OUT:
            self.hidden -= 1
        elif tag in (*_LINES, "section"):
            self.end_line()

    def handle_data(self, data: str) -> None:
        if not self.hidden and data.strip():
            self.words.append(" ".join(data.split()))

    def end_line(self) -> None:
        if self.words:
            self.lines.append(" ".join([f"{self.start}:", *self.words]))
        self.words = []


def report_text(html: str) -> str:
    """One line for each heading, sentence, caption and row of a table."""
    reader = _Reader()
    reader.feed(html)
    reader.end_line()
    return "\n".join(reader.lines) + "\n"
