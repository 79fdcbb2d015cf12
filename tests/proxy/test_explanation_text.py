"""Explanations as people read them."""

import re

import pytest

from proxy.explanation_text import described, ranking
from utility_specs.competing import Competitor
from utility_specs.explaining import explain
from utility_specs.loader import load_set
from utility_specs.terminal_plot import ASCII, BRAILLE

CONSTRAINTS = """\
[[constraint]]
kind = "throughput"
limit = "adaptive"
ceiling = "1 Mbit/s"

[[constraint]]
kind = "energy"
limit = "1 J"
per_byte = "1 uJ"

"""
CAMERA = """\
[[information_type]]
name = "camera"
keys = ["robot/${robot:*}/camera"]
weight = 2
utility = { kind = "linear", slope = 0.5 }
scale = "1 + 10 * red"
features.red = { kind = "json", path = "red" }
features.idle = { kind = "size" }
"""


@pytest.fixture
def text(tmp_path):
    """Explain a sample by specs, as text."""

    def lines(specs, key="robot/r1/camera", payload=b'{"red": 0.35}', style=ASCII, **options):
        file = tmp_path / "specs.toml"
        file.write_text(specs)
        return "\n".join(described(explain(load_set([file]), key, payload, **options), style)).replace(
            f"{tmp_path}/", ""
        )

    return lines


def test_the_worth_is_worked_out_before_the_reader(text):
    """From the key to the number, with the numbers in place of the features."""
    shown = text(CONSTRAINTS + CAMERA)
    assert shown.startswith(
        'robot/r1/camera (13 B): information type "camera"\n'
        "  covered by robot/${robot:*}/camera (specs.toml:13)\n"
        "  which captures robot = r1\n"
        "\n"
        "worth 9 per second when fresh\n"
        "  = weight × scale × utility = 2 × 4.5 × 1\n"
        "  feature red   = 0.35\n"
        "  feature idle  = 13, which nothing uses\n"
        "  weight        = 2\n"
        "  scale         = 1 + 10 * red = 1 + 10 * 0.35 = 4.5\n"
        "  utility       = 1, linear: half of that after 1 s, nothing from 2 s on\n"
    )


def test_the_worth_over_age_is_drawn_and_said(text):
    """A plot with round ages, and the ages that matter."""
    shown = text(CAMERA)
    assert "\n  9 |**" in shown
    assert "age    0  1 s  2 s\nworth  9  4.5    0\n" in shown
    assert "to each robot that has it at once 6.75 in its first second, 9 in all\n" in shown
    assert "\n     0             600 ms        1.2 s        1.8 s         2.4 s\n" in shown
    assert "⠉" in text(CAMERA, style=BRAILLE)


def test_what_it_takes_of_the_limits_is_a_table(text):
    """With whose limit it is, and how many such samples fill it."""
    shown = text(CONSTRAINTS + CAMERA, receivers=3)
    assert shown.startswith("robot/r1/camera (13 B, for 3 robots)")
    throughput, energy = (re.split("  +", line) for line in shown.splitlines()[-2:])
    assert throughput == [
        "throughput",
        "of its ceiling",
        "39 B",
        "62.5 kB in any 500 ms",
        "0.0624 %",
        "3205 per second",
    ]
    assert energy[:2] == ["energy", "each robot's own"]
    assert re.search("200 % +one in 1 s", text(CONSTRAINTS + CAMERA, size=125_000))
    assert re.search("0 % +-\n", text(CONSTRAINTS + CAMERA, size=0))
    assert text(CAMERA).endswith("no limits: the specs have no constraint, so everything can be sent")


def test_defaults_and_failures_say_why(text):
    """So that the reader finds what is wrong."""
    shown = text(CAMERA, payload=b'{"rot": 1}')
    assert '  feature red   = 0, its default: no field "red" in the document (it has: "rot")\n' in shown
    shown = text(CAMERA.replace("1 + 10 * red", "sqrt(1 - red)"), payload=b'{"red": 2}')
    assert "  scale         = sqrt(1 - red) = sqrt(1 - 2): has no value:" in shown
    assert ", so it counts as 1\n" in shown
    shown = text(CAMERA.replace("1 + 10 * red", "red - 1"), payload=b'{"red": 0}')
    assert "  scale         = red - 1 = 0 - 1: is below 0, so it counts as 0\n" in shown
    assert "worth nothing at any age: weight × scale is 0\n" in shown


def test_a_utility_without_an_end_or_with_an_infinite_beginning_is_described(text):
    """Where the words for others do not fit."""
    power = text(CAMERA.replace('"linear", slope = 0.5', '"power", beta = 0.5'))
    assert "worth 142.3 per second at 1 ms, infinite at 0" in power
    table = text(CAMERA.replace('"linear", slope = 0.5', '"table", points = [["0 s", 1.0]]'))
    assert "table: never nothing\n" in table
    assert "9 in its first second, without end after it" in table
    faded = text(CAMERA.replace('"linear", slope = 0.5', '"exponential", tau = "1 min"'))
    assert "half of that after 41.6 s, less than 1 % from 4 min 36 s on\n" in faded
    step = text(CAMERA.replace('"linear", slope = 0.5', '"step", lifetime = "1 s"'))
    assert "step: nothing from 1 s on\n" in step
    day = text(CAMERA.replace('"linear", slope = 0.5', '"step", lifetime = "5 h"'))
    assert "5 h 15 min" in day


def test_a_function_that_fails_is_told(text):
    """The defaults of all features hold for it."""
    shown = text(
        CAMERA.replace('"linear", slope = 0.5', '"python", function = "tests.utility_specs.worths:by_red"'),
        payload=b'{"red": -1}',
    )
    assert "the function of the utility fails for these features" in shown


def test_what_the_type_says_besides_is_told(text):
    """Guarantees, modes and how samples combine."""
    rules = 'mode = "shadow"\nmin_rate = "0.5 Hz"\nmax_age = "5 s"\nbypass = true\naggregation = "once"\n'
    shown = text(CAMERA + rules.replace("features", ""))
    assert "aggregation once: only the first that a robot received counts" in shown
    assert "mode shadow, whatever the daemon's is unless that is pass\n" in shown
    assert "bypass: goes at once" in shown
    assert "min_rate: 0.5 samples of its stream per second" in shown
    assert "max_age: no receiver's last sample shall get older than 5 s\n" in shown


def test_types_that_come_later_and_keys_that_are_near_are_told(text):
    """Why this one, and why none."""
    rest = '[[information_type]]\nname = "rest"\nkeys = ["robot/**"]\nutility = { kind = "video" }\n'
    assert '  "rest" comes later, so its robot/** does not count here (specs.toml:11)\n' in text(CAMERA + rest)
    shown = text(CAMERA, key="robot/r1/camra")
    assert shown.startswith("robot/r1/camra (13 B): no information type covers this key\n  so its samples pass at once")
    assert '  near is robot/${robot:*}/camera, but "camra" is not "camera"\n' in shown


def test_competitors_are_a_table():
    """With a mark at the sample itself; what is not known is a dash."""
    found = [Competitor("a", 2000.0, 1e6, this=True), Competitor("bee", None, None, note="size not known")]
    assert list(ranking(found, "TYPE")) == [
        "   TYPE  FIRST SECOND  SIZE  PER kB",
        ">  a             2000  1 MB       2",
        "   bee              -     -       -  size not known",
    ]
