"""Reading TOML files, and saying where in them a mistake is."""

import os
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict, ValidationError

from utility_specs.errors import TomlError
from utility_specs.toml_source import LARGEST_FILE, MOST_MARKS, MOST_PROBLEMS, TomlSource, problems_of

FILE = Path("some.toml")
TEXT = """\
robot = "r1"
[app]
listen = ["tcp/127.0.0.1:7447"]
[[type]]
name = "camera"
use.red = { color = "red" }
[[type]]
"""


class Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class App(Strict):
    listen: list[str] = []
    iterations: int = 3


class Config(Strict):
    robot: str = ""
    app: App = App()


def message(path: Path) -> str:
    with pytest.raises(TomlError) as caught:
        TomlSource.read(path)
    assert len(caught.value.problems) == 1
    return str(caught.value)


def test_a_file_is_read_with_its_values_and_lines(tmp_path):
    """The data are those of the file, and each key has its line."""
    path = tmp_path / "good.toml"
    path.write_text(TEXT)
    source = TomlSource.read(path)
    assert source.data["app"] == {"listen": ["tcp/127.0.0.1:7447"]}
    assert source.line_of(("app", "listen", 0)) == 3
    assert source.text == TEXT


def test_a_key_that_is_missing_is_shown_at_the_table_around_it():
    """Where nothing is written, the nearest enclosing table is the place."""
    source = TomlSource.parse(FILE, TEXT)
    assert source.line_of(("type", 1, "keys")) == 7
    assert source.line_of(("app", "listen", 0, "x", "y")) == 3
    assert source.line_of(("mesh", "listen")) is None
    assert source.line_of(()) is None


@pytest.mark.parametrize(
    ("path", "label"),
    [
        (("app", "listen"), "app.listen"),
        (("app", "listen", 0), "app.listen[0]"),
        (("type", 0, "use", "red", "color"), 'type "camera": use.red.color'),
        (("type", 0), 'type "camera"'),
        (("type", 1, "keys"), "type #2: keys"),
        (("two words", "x"), '"two words".x'),
        ((), ""),
    ],
)
def test_a_key_is_labelled_as_its_reader_knows_it(path, label):
    """Items of arrays go by their names, all else by dotted keys."""
    assert TomlSource.parse(FILE, TEXT).label(path) == label


def test_a_problem_names_file_line_and_key():
    """A problem made from a source carries its place."""
    problem = TomlSource.parse(FILE, TEXT).problem(("type", 0, "use"), "is odd")
    assert str(problem) == 'some.toml:6: type "camera": use: is odd'


def test_what_pydantic_finds_is_told_with_lines_in_the_order_of_the_file():
    """A validation error becomes one problem per mistake, with hints from the model."""
    source = TomlSource.parse(FILE, "[app]\nlisten = [1]\niteration = 3\n[apq]\n")
    with pytest.raises(ValidationError) as caught:
        Config.model_validate(source.data)
    assert [str(problem) for problem in problems_of(caught.value, source, Config)] == [
        "some.toml:2: app.listen[0]: must be a string, not 1",
        'some.toml:3: app.iteration: unknown key (did you mean "iterations"?)',
        'some.toml:4: apq: unknown key (did you mean "app"?)',
    ]
    assert problems_of(caught.value, source)[1].message == "unknown key"


def test_of_a_file_full_of_mistakes_the_first_are_told():
    """Nobody reads more, and hints take time."""
    source = TomlSource.parse(FILE, "".join(f"key{i} = 1\n" for i in range(3_000)))
    with pytest.raises(ValidationError) as caught:
        Config.model_validate(source.data)
    problems = [str(problem) for problem in problems_of(caught.value, source, Config)]
    assert len(problems) == MOST_PROBLEMS + 1
    assert problems[0] == 'some.toml:1: key0: unknown key (known keys: "robot", "app")'
    assert problems[-1] == "some.toml: has 2950 more mistakes"


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (b"a = 1\nb = \n", ":2: not valid TOML: Invalid value (column 5)"),
        (b"a = 2 Mbit/s", ":1: not valid TOML: Expected newline or end of document after a statement (column 7); text"),
        (
            b"a = { b = 3s, c = 1 }",
            ":1: not valid TOML: Unclosed inline table (column 12); text and quantities stand in",
        ),
        (b"\na = high", ':2: not valid TOML: Invalid value (column 5); text and quantities stand in quotes: "high"'),
        (b"a = { b = true c }", ":1: not valid TOML: Unclosed inline table (column 16)"),
        (b"a = 1\n\nb = 'x", ':3: not valid TOML: Expected "\'" at the end of the file'),
        (b"[a.b]\n[a.b]\n", ":2: not valid TOML: Cannot declare a.b twice (column 5)"),
        (b"a = 1\nb = '\xff'\n", ":2: is not UTF-8 (byte 0xff); save the file as UTF-8"),
        (b"a = " + b"[" * 2000, ": arrays or tables are nested too deeply"),
        (b"x = 1\na" + b".a" * 100 + b" = 1", ":2: a key of more than 64 parts"),
        (b"a = " + b"1" * 5000, ":1: not valid TOML: a number of more than 4300 digits"),
        (
            b"#" + b"1" * 5000 + b"\r\na = [\r\n1,\r\n" + b"1" * 5000 + b", 2,\r\n3\r\n]\r\nb = " + b"1" * 5000,
            ":4: not valid TOML: a number of more than 4300 digits",
        ),
        (b"#" * (LARGEST_FILE + 1), ": is larger than 128 KiB"),
        (b"a = [" + b"1," * MOST_MARKS + b"]", ": has more than 3072 keys and values; write several files"),
    ],
)
def test_a_file_that_is_not_toml_is_refused_with_its_line(tmp_path, raw, expected):
    """Each kind of broken text has its message and, where there is one, its line."""
    path = tmp_path / "bad.toml"
    path.write_bytes(raw)
    assert message(path).startswith(f"{path}{expected}")


def test_a_byte_order_mark_is_no_mistake(tmp_path):
    """What Windows editors put in front of a file is skipped."""
    path = tmp_path / "bom.toml"
    path.write_bytes(b"\xef\xbb\xbfa = 1\r\nb = 2\r\n")
    assert TomlSource.read(path).line_of(("b",)) == 2


def test_files_that_cannot_be_read_are_refused_by_name(tmp_path):
    """Missing files, folders, pipes and paths through files each say what they are."""
    file, pipe = tmp_path / "file.toml", tmp_path / "pipe.toml"
    file.touch()
    os.mkfifo(pipe)
    assert message(tmp_path / "none.toml") == f"{tmp_path}/none.toml: does not exist"
    assert message(tmp_path) == f"{tmp_path}: is not a file"
    assert message(pipe) == f"{pipe}: is not a file"
    assert message(file / "x.toml") == f"{file}/x.toml: cannot be read: Not a directory"
    assert "cannot be read: embedded null" in message(tmp_path / "a\0b")


@given(st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_bytes_are_either_toml_or_one_clear_error(tmp_path_factory, raw):
    """Reading raises nothing but TomlError."""
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_bytes(raw)
    with suppress(TomlError):
        assert TomlSource.read(path).text.encode() in raw.replace(b"\r\n", b"\n") + raw
