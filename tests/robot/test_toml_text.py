"""The door for TOML files: what a few kilobytes must not cost, and what is said of keys that are not known."""

from __future__ import annotations

from pathlib import Path

import pytest

from puma_septic.errors import ModelError
from puma_septic.robot._toml_text import read_toml, table


def read(folder: Path, text: str) -> dict:
    path = folder / "f.toml"
    path.write_text(text, encoding="utf-8")
    return read_toml(path, "test file")


@pytest.mark.parametrize(
    "key",
    [
        "a." * 16 + "a",
        "a . " * 16 + "a",
        '"a".' * 16 + "a",
        '" ".' * 16 + "a",  # a blank, a bracket or an equals sign between quotes once hid the key from the guard
        '"[".\'"["\'.' * 8 + "a",
        "'='." * 16 + "a",
        '"\\"".' * 16 + "a",
        "''." * 16 + "a",
    ],
)
def test_a_key_of_many_parts_is_refused_before_it_is_read(tmp_path: Path, key: str) -> None:
    """Ten thousand parts, 20 kB, cost the parser of Python half a gigabyte."""
    after_a_text = f"x = '''\n\" # it's\n'''\n{key} = 1"
    for text in (f"{key} = 1", f"[{key}]", f"[[{key}]]", f"x = {{ {key} = 1 }}", after_a_text):
        with pytest.raises(ModelError, match=r"f\.toml: a key with more than 16 dotted parts is not allowed"):
            read(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ('"1.2.3.4.5.6.7.8.9.10.11.12.13.14.15.16.17"', "1.2.3.4.5.6.7.8.9.10.11.12.13.14.15.16.17"),
        (f"'{'a.' * 20}'", "a." * 20),
        (f'"""\n{"a." * 20}"""', "a." * 20),
        (f"'''{'a.' * 20}'''", "a." * 20),
        (f"1 # {'a.' * 20}a", 1),
        (f'"\\"{"a." * 20}" # "', '"' + "a." * 20),
    ],
)
def test_dots_in_texts_and_remarks_are_no_parts_of_a_key(tmp_path: Path, text: str, value: object) -> None:
    """A source with a version number of 17 parts was once taken for a key."""
    assert read(tmp_path, f"x = {text}\n{'.'.join('abcdefghijklmnop')} = 2\n")["x"] == value


def test_an_integer_is_one_of_64_bits(tmp_path: Path) -> None:
    """An integer of 20,000 bits was read, and then the message about it could not be written: ValueError."""
    assert read(tmp_path, f"x = [{2**63 - 1}, {-(2**63)}]")["x"] == [2**63 - 1, -(2**63)]
    with pytest.raises(ModelError, match=r"f\.toml, a, b, 1: an integer beyond 64 bits; valid: -2\^63 to 2\^63 - 1"):
        read(tmp_path, f"[a]\nb = [1, 0x{'f' * 5000}]")
    for beyond in (2**63, -(2**63) - 1):
        with pytest.raises(ModelError, match=r"f\.toml, x: an integer beyond 64 bits; valid"):
            read(tmp_path, f"x = {beyond}")
    with pytest.raises(ModelError, match="not valid TOML: Exceeds the limit"):
        read(tmp_path, f"x = {'9' * 5000}")


def test_what_is_no_toml_is_told_with_its_reason(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"f\.toml: not valid TOML: Invalid value"):
        read(tmp_path, "x = ")
    with pytest.raises(ModelError, match="not valid TOML"):
        read(tmp_path, "x = " + "[" * 20_000)
    assert read(tmp_path, "#" * 64_000) == {}
    with pytest.raises(ModelError, match=r"larger than 0\.064 MB"):
        read(tmp_path, "#" * 64_001)
    with pytest.raises(ModelError, match="this test file does not exist"):
        read_toml(tmp_path / "none.toml", "test file")


def test_unknown_keys_are_told_all_at_once_with_what_is_near() -> None:
    with pytest.raises(
        ModelError, match=r"f: unknown key 'joint', 'x'; valid: schema, robot, joints; did you mean 'joints'\?$"
    ):
        table({"joint": 1, "schema": 1, "x": 2}, "f", ("schema", "robot", "joints"))
    with pytest.raises(ModelError, match=r"f: unknown joint 'hand'; valid: elbow, wrist$"):
        table({"hand": 1}, "f", ("elbow", "wrist"), kind="joint")
    with pytest.raises(ModelError, match=r"f: expected a table, got \[1\]"):
        table([1], "f")
    assert table({"anything": 1}, "f") == {"anything": 1}
