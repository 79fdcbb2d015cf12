"""What `sendworthy check` finds in specs that can be loaded: each finding by its line, key and words."""

import pytest

from utility_specs.findings import findings
from utility_specs.loader import load_set

LIMIT = """\
[[constraint]]
kind = "throughput"
limit = "80 kbit/s"
"""
CAMERA = """\
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "video" }
"""


@pytest.fixture
def find(tmp_path):
    """What is found in a text, without the file's name: errors first, then warnings."""

    def find(text):
        path = tmp_path / "spec.toml"
        path.write_text(text)
        found = [(each.unfit, str(each.problem).removeprefix(f"{path}:")) for each in findings(load_set([path]).files)]
        return [text for unfit, text in found if unfit], [text for unfit, text in found if not unfit]

    return find


def test_specs_that_fit_are_left_alone(find):
    """Nothing is made up: guarantees of the whole limit fit, and different limits do bind."""
    fits = CAMERA + 'min_rate = "2 Hz"\nforecast = { size = "5 kB", schedule = { kind = "periodic", period = 0.5 } }\n'
    assert find(LIMIT + fits) == ([], [])
    assert find(LIMIT + LIMIT.replace("80", "800") + "window = 0.01\n" + CAMERA) == ([], [])


@pytest.mark.parametrize(
    ("guarantee", "share"),
    [
        ('min_rate = "2 Hz"\nforecast = { size = "6 kB" }', "120 %"),
        ('min_rate = "1 Hz"\nforecast = { size = "6 kB", streams = 2 }', "120 %"),
        ('max_age = "500 ms"\nforecast = { size = "10 kB" }', "200 %"),
        ('min_rate = "1 mHz"\nmax_age = "1 s"\nforecast.size = "20 kB"\nforecast.schedule = "auto"', "200 %"),
        ('min_rate = "1 Hz"\nforecast = { size = "15 kB", schedule = { kind = "poisson", rate = "1 Hz" } }', "150 %"),
    ],
)
def test_guarantees_beyond_a_limit_make_specs_unfit(find, guarantee, share):
    """What all streams need at least, in one copy each, against what there is."""
    errors, _ = find(LIMIT + CAMERA + guarantee)
    assert errors == [f'3: constraint #1: limit: is less than what is guaranteed: "camera" ({share})']


def test_guarantees_of_all_types_add_up(find):
    """Each fits, and together they do not; a limit that follows the channel may fall below them."""
    camera = CAMERA + 'min_rate = "1 Hz"\nforecast.size = "6 kB"\n'
    two = camera + camera.replace("camera", "scan")
    assert find(LIMIT + camera)[0] == []
    assert find(LIMIT + two)[0] == [
        '3: constraint #1: limit: is less than what is guaranteed: "camera" (60 %), "scan" (60 %)'
    ]
    adaptive = LIMIT.replace('"80 kbit/s"', '"adaptive"\nceiling = "160 kbit/s"')
    assert find(adaptive + two) == (
        [],
        [
            (
                "3: constraint #1: limit: at its floor, 0.2 % of the ceiling, is less than what is guaranteed: "
                '"camera" (30 %), "scan" (30 %)'
            )
        ],
    )


def test_energy_is_each_robots_own(find):
    """Streams of all robots together do not count against the battery of one."""
    energy = '[[constraint]]\nkind = "energy"\nlimit = "1 J"\nwindow = 0.1\nper_message = "0.6 J"\n'
    assert find(energy + CAMERA + 'min_rate = "10 Hz"\nforecast.streams = 9') == ([], [])
    assert find(energy + CAMERA + 'min_rate = "20 Hz"\n')[0] == [
        '3: constraint #1: limit: is less than what is guaranteed: "camera" (120 %)'
    ]


@pytest.mark.parametrize(
    ("schedule", "rate"),
    [
        ('{ kind = "periodic", period = "2 s" }', "0.5"),
        ('{ kind = "poisson", interval = "4 s" }', "0.25"),
        ('{ kind = "times", times = [0, 1, 2], every = "6 s" }', "0.5"),
    ],
)
def test_nobody_can_send_what_is_not_generated(find, schedule, rate):
    """A guarantee above the known rate is a mistake, whatever the limits."""
    says = f"and forecast.schedule says that there are {rate}"
    text = CAMERA + f'max_age = "500 ms"\nmin_rate = "1 Hz"\nforecast.schedule = {schedule}\n'
    assert find(text)[0] == [
        f'5: information_type "camera": max_age: takes 2 samples per second, {says}',
        f'6: information_type "camera": min_rate: takes 1 samples per second, {says}',
    ]
    once = text[: text.index("forecast")] + 'forecast.schedule = { kind = "times", times = [0] }\n'
    assert find(once) == ([], [])


@pytest.mark.parametrize(
    ("tables", "warning"),
    [
        (
            LIMIT + CAMERA + 'forecast.size = "50 kB"',
            (
                '8: information_type "camera": forecast.size: is 10 times what "throughput" lets pass in 0.5 s: '
                "one can be sent every 5 s, and little beside it"
            ),
        ),
        (
            LIMIT.replace("80 kbit/s", "8 bit/s") + CAMERA,
            (
                "3: constraint #1: limit: is too low for a single sample of one byte in any 0.5 s: "
                "almost nothing can be sent"
            ),
        ),
        (
            LIMIT.replace("80 kbit/s", "5 kbit/s") + CAMERA,
            (
                "3: constraint #1: limit: 64 % of it is for what the daemons of 4 robots tell each other, "
                "100 B/s for each, which leaves 112 B in 0.5 s to samples: raise it, or set the same rate over a "
                "longer window, until each robot's part holds a sample"
            ),
        ),
        (
            CAMERA + CAMERA.replace('"camera"', '"front"').replace("*", "r1"),
            '7: information_type "front": keys: all belong to "camera" before it, so this type covers nothing',
        ),
        (
            CAMERA + CAMERA.replace('"camera"', '"all"').replace('["', '["robot/${robot:*}/camera", "'),
            '7: information_type "all": keys: all belong to "camera" before it, so this type covers nothing',
        ),
        (
            CAMERA + CAMERA.replace('"camera"', '"all"').replace('["', '["robot/**", "'),
            '7: information_type "all": keys: "robot/*/camera" belongs to "camera" before it',
        ),
        (
            CAMERA + 'features.size = { kind = "size" }',
            '5: information_type "camera": features.size: nothing uses this feature; it is computed all the same',
        ),
        (
            "constants.bonus = 3\n" + CAMERA,
            "1: constants.bonus: nothing in this file uses this constant",
        ),
        (
            CAMERA + 'bypass = true\nmin_rate = "1 Hz"',
            '6: information_type "camera": min_rate: has no effect: nothing decides on this type',
        ),
        (
            CAMERA + 'mode = "pass"\nmax_age = "1 s"',
            '6: information_type "camera": max_age: has no effect: nothing decides on this type',
        ),
        (
            CAMERA + 'aggregation = "once"\nmin_rate = "1 Hz"',
            (
                '6: information_type "camera": min_rate: ends with the first sample: '
                'with aggregation = "once" each robot is sent no other'
            ),
        ),
        (
            CAMERA + 'bypass = true\nmode = "enforce"',
            '6: information_type "camera": mode: has no effect: with bypass everything goes',
        ),
        (
            LIMIT + LIMIT.replace("80", "90") + CAMERA,
            '6: constraint #2: limit: never binds: "throughput" lets no more pass',
        ),
        (
            LIMIT + LIMIT.replace("80", "40") + 'name = "low"\n' + CAMERA,
            '3: constraint #1: limit: never binds: "low" lets no more pass',
        ),
        (
            LIMIT + LIMIT + CAMERA,
            '6: constraint #2: limit: never binds: "throughput" lets no more pass',
        ),
        (
            LIMIT + LIMIT.replace('"80 kbit/s"', '"adaptive"\nceiling = "8 Mbit/s"\nfloor = "1 Mbit/s"') + CAMERA,
            '6: constraint #2: limit: even at its floor it never binds: "throughput" lets no more pass',
        ),
    ],
)
def test_what_is_hardly_meant_is_a_warning(find, tables, warning):
    """Specs like these can be flown."""
    assert find(tables) == ([], [warning])


def test_a_python_utility_uses_every_feature(find):
    """Its function gets all of them."""
    python = '{ kind = "python", function = "tests.utility_specs.worths:by_red" }'
    text = CAMERA.replace('{ kind = "video" }', python)
    assert find(text + 'features.red = { kind = "color_fraction", color = "red" }\n') == ([], [])


def test_what_is_found_comes_in_the_order_of_files_and_lines(tmp_path):
    """Also across files."""
    (tmp_path / "b.toml").write_text(CAMERA.replace('"camera"', '"late"') + 'features.size = { kind = "size" }\n')
    (tmp_path / "a.toml").write_text("constants = { x = 1, y = 2 }\n" + CAMERA)
    found = findings(load_set([tmp_path]).files)
    assert next((each.problem.file.name, each.problem.line) for each in found) == ("a.toml", 1)
    assert [(each.problem.file.name, each.problem.line) for each in found][-2:] == [("b.toml", 3), ("b.toml", 5)]
