"""Importing functions by their path."""

import math

import pytest

from utility_specs.imports import imported, nothing_imported


def test_a_function_is_found_by_its_path():
    """In modules and in packages; classes and other callables too."""
    assert imported("math:sqrt") is math.sqrt
    assert imported("os.path:join").__name__ == "join"
    assert imported("fractions:Fraction")(1, 2) == 0.5


@pytest.mark.parametrize(
    "path", ["", "math", "math.sqrt", "math:", ":sqrt", "math:a.b", "a b:c", "math:sqrt:x", ".a:b", "1:2"]
)
def test_what_is_no_path_is_refused_with_an_example(path):
    """Nothing is imported for it."""
    with pytest.raises(ValueError, match=r'is not the path of a function; write "package\.module:name"'):
        imported(path)


@pytest.mark.parametrize(
    ("source", "says"),
    [
        ("x = 1 +", "SyntaxError: invalid syntax"),
        ("raise RuntimeError('one\\ntwo')", "RuntimeError: one two"),
        ("raise SystemExit(3)", "SystemExit: 3"),
        ("import asyncio; raise asyncio.CancelledError('late')", "CancelledError: late"),
        ("import nothing_of_this_name", "ModuleNotFoundError: No module named 'nothing_of_this_name'"),
    ],
)
def test_a_module_that_fails_is_named_with_its_failure(source, says, tmp_path, monkeypatch):
    """On one line, and the process goes on."""
    (tmp_path / "failing_module.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ValueError, match=f'^cannot import "failing_module": {says}'):
        imported("failing_module:f")


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("math:sqr", r'"math" has no "sqr" \(did you mean "sqrt"\?\)'),
        ("math:pi", '"math:pi" is a float, not a function'),
        ("nothing_of_this_name:f", 'cannot import "nothing_of_this_name": ModuleNotFoundError'),
    ],
)
def test_a_name_that_is_no_function_is_refused(path, says):
    """With what is there instead."""
    with pytest.raises(ValueError, match=says):
        imported(path)


def test_nothing_is_imported_of_specs_that_a_stranger_may_have_written(tmp_path, monkeypatch):
    """Not even a module that is there; afterwards everything is again."""
    (tmp_path / "hostile_module.py").write_text("raise RuntimeError('it ran')")
    monkeypatch.syspath_prepend(tmp_path)
    for path in ("hostile_module:f", "os:system"):
        with nothing_imported("who knows"), pytest.raises(ValueError, match=f'^"{path}" is not imported: who knows$'):
            imported(path)
    assert imported("math:sqrt")(4.0) == 2.0
