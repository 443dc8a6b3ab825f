"""Mutations that all text formats share: of bytes, of lines, of numbers and of words."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

Rng = np.random.Generator
NUMBER: Final = re.compile(r"(?<![\w.])[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![\w.])")
WORD: Final = re.compile(r"[A-Za-z_][A-Za-z_0-9]{2,}")
# Numbers that parsers read differently or not at all, that overflow, vanish, or turn a sign.
HOSTILE: Final = (
    "nan", "inf", "-inf", ".nan", ".inf", "1e308", "-1e308", "1e309", "1e-320", "-0", "0", "0.0", "-1", "1_000",
    "0x10", "0xff", "0o17", "1,5", "1.5.2", "1e", "--1", "+1", ".5", "5.", "1d0", "1e+2", "٣", "1 ", " 1", "1\u00a0",
    "½", "1/2", "true", "null", "", '""', "[]", "{}", "[1, 2]", "9" * 400, "9" * 5000, "0." + "3" * 400, "1:30",
    "2026-01-01", "1e150", "1e-150", "1e16", "1e7", "3.14159265358979323846", "-3.2", "100", "1e-9",
    "0xf" + "f" * 300, "\u202e1", "\x1b[2J",
)  # fmt: skip
# What a number may become and still be one, for all parsers alike.
GENTLE: Final = ("{}", "{:+}", "{:e}", "{:.3f}", "{:.17g}", "{:g} ", " {:g}", "{:.1f}")
NAMES: Final = (
    "", " ", "x" * 300, "=cmd|' /C calc'!A0", "＝1+1", "a$b_{$c", "$x^2$", "../../up", "a/b", "..", "nan", "universe",
    "\x1b]0;title\x07", "\u202eevil", "\u0085", "<script>alert(1)</script>", "naïve-关节", "e\u0301", "null", "yes",
    "1", "-", "\u2028", "a b", "a\tb", "'", '"', "%s{0}{x}", "NAME", "joint1", "x" * 5000,
)  # fmt: skip
_PUT_IN: Final = (b"\x00", b"\xff\xfe", b"\r", b"\t", b"\xe2\x80\xae", b"\x1b[31m", b"\xc2\x85")


def chosen(rng: Rng, values: Sequence[str]) -> str:
    return values[int(rng.integers(len(values)))]


def mangled_bytes(rng: Rng, data: bytes) -> bytes:
    """Bytes changed, cut, doubled or put in: what a bad disk, a bad editor or a bad joker does."""
    for _ in range(int(rng.integers(1, 4))):
        if not data:
            return bytes(rng.integers(0, 256, 8, dtype=np.uint8))
        start = int(rng.integers(len(data)))
        end = min(len(data), start + int(rng.geometric(0.05)))
        patch = (
            lambda part: bytes(rng.integers(0, 256, len(part), dtype=np.uint8)),
            lambda _: b"",
            lambda part: part * int(rng.integers(2, 5)),
            lambda part: part[::-1],
            lambda part: part + chosen(rng, HOSTILE).encode("utf-8"),
            lambda part: part.swapcase(),
            lambda part: _PUT_IN[int(rng.integers(len(_PUT_IN)))] + part,
        )[int(rng.integers(7))]
        data = data[:start] + patch(data[start:end]) + data[end:]
    rare = rng.random()
    if rare < 0.02:
        return data[: int(rng.integers(len(data) + 1))]
    if rare < 0.04:
        return data.decode("utf-8", "replace").encode(chosen(rng, ("utf-16", "utf-32", "utf-8-sig", "utf-16-le")))
    return data


def changed_number(rng: Rng, text: str) -> str:
    """Another number, or what is none, in place of one: mostly gentle, so that much is accepted."""
    kind = rng.random()
    try:
        value = float(text)
    except ValueError:
        return chosen(rng, HOSTILE)
    if kind < 0.35:
        return chosen(rng, GENTLE).format(value)
    if kind < 0.55:
        return repr(float(value * rng.choice([-1, 0.5, 2, 10, 1e3, 1e-3, 1e6, 1 + 1e-9])))
    if kind < 0.7:
        return repr(float(rng.normal(scale=10.0 ** rng.integers(-3, 4))))
    return chosen(rng, HOSTILE)


def mutated_text(rng: Rng, text: str, extra: Sequence[Callable[[Rng, str], str]] = ()) -> str:
    """One to three changes of a text; `extra` are those that know its format."""
    common = (_number, _number, _number, _word, _line_out, _line_doubled, _lines_swapped, _line_indented, _character)
    for _ in range(int(rng.integers(1, 4))):
        steps = (*common, *extra)
        text = steps[int(rng.integers(len(steps)))](rng, text)
    return text


def replaced(rng: Rng, pattern: re.Pattern[str], text: str, change: Callable[[str], str]) -> str:
    """The text with one match of a pattern changed; as it is where there is none."""
    found = list(pattern.finditer(text))
    if not found:
        return text
    match = found[int(rng.integers(len(found)))]
    return text[: match.start()] + change(match[0]) + text[match.end() :]


def _number(rng: Rng, text: str) -> str:
    return replaced(rng, NUMBER, text, lambda number: changed_number(rng, number))


def _word(rng: Rng, text: str) -> str:
    kind = rng.random()
    if kind < 0.4:
        return replaced(rng, WORD, text, lambda word: misspelt(rng, word))
    if kind < 0.7:
        other = WORD.findall(text) or ["x"]
        return replaced(rng, WORD, text, lambda _: chosen(rng, other))
    return replaced(rng, WORD, text, lambda _: chosen(rng, NAMES))


def misspelt(rng: Rng, word: str) -> str:
    k = int(rng.integers(len(word)))
    return (word[:k] + word[k + 1 :], word[:k] + word[k] + word[k:], word.upper(), word[::-1], f"{word}s")[
        int(rng.integers(5))
    ]


def _on_lines(rng: Rng, text: str, change: Callable[[list[str], int], None]) -> str:
    lines = text.split("\n")
    change(lines, int(rng.integers(len(lines))))
    return "\n".join(lines)


def _line_out(rng: Rng, text: str) -> str:
    return _on_lines(rng, text, lambda lines, k: lines.pop(k))


def _line_doubled(rng: Rng, text: str) -> str:
    return _on_lines(rng, text, lambda lines, k: lines.insert(k, lines[k]))


def _lines_swapped(rng: Rng, text: str) -> str:
    def swap(lines: list[str], k: int) -> None:
        other = int(rng.integers(len(lines)))
        lines[k], lines[other] = lines[other], lines[k]

    return _on_lines(rng, text, swap)


def _line_indented(rng: Rng, text: str) -> str:
    def indent(lines: list[str], k: int) -> None:
        lines[k] = chosen(rng, ("  ", "\t", "    ", "- ", "# ")) + lines[k]

    return _on_lines(rng, text, indent)


def _character(rng: Rng, text: str) -> str:
    k = int(rng.integers(len(text) + 1))
    signs = (
        "'", '"', ":", ",", "=", "[", "]", "{", "}", "#", "&a ", "*a", "!!python/object:os.system ", "\x1b[31m", "\t",
        "\u202e", "\u0085", "\u00a0", "\x00", "é", "🤖", "\r\n", ";",
    )  # fmt: skip
    return text[:k] + chosen(rng, signs) + text[k:]
