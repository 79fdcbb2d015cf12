"""Specs near the largest that are read, each made so that judging it takes long."""

from collections.abc import Callable

from utility_specs.expressions import LONGEST
from utility_specs.toml_source import LARGEST_FILE, MOST_MARKS, marks


def _filled(unit: Callable[[int], str], end: str = "x = 1\n") -> str:
    """Return as many units, whole lines each, as a file may have, and its `end`."""
    units: list[str] = []
    size, signs = len(end.encode()), marks(end)
    while True:
        text = unit(len(units))
        size, signs = size + len(text.encode()), signs + marks(text)
        if size > LARGEST_FILE or signs > MOST_MARKS:
            return "".join(units) + end
        units.append(text)


def _type(number: int, more: str = "", keys: str = "", utility: str = '{ kind = "video" }') -> str:
    keys = keys or f'"r/{number}/*"'
    head = f'[[information_type]]\nname = "t{number}"\nkeys = [{keys}]\nutility = {utility}\n'
    return head + more


def _wild(number: int) -> str:
    return ",".join(f"'*/**/a{number}x{k}/**'" for k in range(25))


_LONG = "*".join(["(1+1)"] * 45) + " " * (LONGEST - 270)
_NESTED = "1/(1+" * 22 + "1" + ")" * 22
_WILDEST = "**/a/" * 60
_CONSTANTS = "[constants]\n" + "".join(f"c{i}abcdefghijk = 1\n" for i in range(64))
_LATE = "min_rate = '9 Hz'\nforecast.schedule = { kind = 'periodic', period = 1 }\n"

HEAVY = {
    "keys": _filled(lambda i: f"k{i}=1\n"),
    "quoted keys": _filled(lambda i: f'"\\u00e9k{i}"=1\n'),
    "dotted keys": _filled(lambda i: ".".join([f"a{i}"] * 60) + "=1\n"),
    "headers": _filled(lambda i: f"[k{i}]\n", ""),
    "an array": "x = [" + "1," * (MOST_MARKS - 2) + "]",
    "blanks": "\n" * (LARGEST_FILE - 3) + "x=1",
    "text": 'x = "' + "\\n" * (LARGEST_FILE // 2 - 4) + '"',
    "types": _filled(lambda i: _type(i) if i < 128 else f"#{i}\n"),
    "types without anything": _filled(lambda _: "[[information_type]]\n"),
    "one type again and again": _filled(lambda _: _type(0)),
    "long expressions": _filled(lambda i: _type(i, f'scale = "{_LONG}"\n')),
    "nested expressions": _filled(lambda i: _type(i, f'scale = "{_NESTED}"\n')),
    "unknown names": _CONSTANTS + "".join(_type(i, f'scale = "x{i}abcdefghijk"\n') for i in range(120)),
    "constants": "[constants]\n" + _filled(lambda i: f'c{i}="1 mn"\n')[:-6],
    "unknown modules": "".join(
        _type(
            i,
            f"aggregation = {{ python = 'nope{i}:a' }}\nforecast = {{ features = {{ python = 'nopf{i}:a' }} }}\n",
            utility=f'{{ kind = "python", function = "nopu{i}:a" }}',
        )
        for i in range(120)
    ),
    "forecasts": "".join(
        _type(i, "forecast.features = {" + ",".join(f"a{j} = {{ python = 'n{i}x{j}:f' }}" for j in range(60)) + "}\n")
        for i in range(14)
    ),
    "features": _filled(lambda i: _type(i, "".join(f"features.f{j} = {{ kind = 'siz' }}\n" for j in range(64)))),
    "guarantees nobody can keep": "".join(
        f"[[constraint]]\nkind = 'messages'\nlimit = 1\nwindow = {50 - i}\n" for i in range(32)
    )
    + "".join(_type(i, _LATE) for i in range(120)),
    "wild keys": "".join(_type(i, _LATE, _wild(i)) for i in range(10)),
    "many wild keys": "".join(_type(i, keys=_wild(i)) for i in range(40)),
    "wildest keys": _filled(lambda i: _type(i, keys=",".join(f"'{_WILDEST}{i}x{k}'" for k in range(30)))),
}
"""By what there is much of. None is fit to fly."""
