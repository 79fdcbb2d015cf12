"""Why a sample is worth what it is."""

import json

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.problem import Aggregation
from tests.utility_specs import outlooks
from utility_specs.explaining import AGGREGATIONS, combined, explain, figure, kind_of
from utility_specs.loader import load_set

SPECS = """\
[constants]
bonus = 10

[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"

[[constraint]]
kind = "energy"
limit = "0.5 J"
per_byte = "2 uJ"

[[information_type]]
name = "camera"
keys = [
    "robot/${robot:*}/cam/${n:*}",
    "robot/${robot:*}/camera/${n:*}",
]
weight = "2 if robot == 'leader' else 1"
utility = { kind = "video" }
features.red = { kind = "json", path = "red", default = 0.5 }
features.idle = { kind = "size" }
scale = "(1 + bonus * red) / (1 + n)"

[[information_type]]
name = "rest"
keys = ["robot/**"]
utility = { kind = "step", lifetime = "1 s" }
"""


@pytest.fixture
def specs(tmp_path):
    """Load specs from a text."""

    def load(text=SPECS):
        file = tmp_path / "specs.toml"
        file.write_text(text)
        return load_set([file])

    return load


def test_the_type_and_its_key_expression_are_told_with_their_place(specs, tmp_path):
    """The first one that covers the key, as it is written, and those that would have."""
    worth = explain(specs(), "robot/leader/camera/3", b"{}").worth
    assert worth.type.name == "camera"
    assert worth.covering.expression == "robot/${robot:*}/camera/${n:*}"
    assert worth.covering.place == f"{tmp_path}/specs.toml:17"
    assert [(each.type, each.line) for each in worth.later] == [("rest", 27)]
    assert worth.captured == {"robot": "leader", "n": "3"}


def test_features_weight_and_scale_are_worked_out(specs):
    """With the numbers in place of names, to the end."""
    worth = explain(specs(), "robot/leader/camera/3", b'{"red": 0.3}').worth
    assert [(each.name, each.value, each.why, each.used) for each in worth.features] == [
        ("red", 0.3, None, True),
        ("idle", 12.0, None, False),
    ]
    assert worth.weight.filled == "2 if 'leader' == 'leader' else 1"
    assert worth.scale.filled == "(1 + 10 * 0.3) / (1 + 3)"
    assert (worth.weight.value, worth.scale.value, worth.factor) == (2.0, 1.0, 2.0)
    assert worth.value == pytest.approx(2.0 * worth.lifetime.first_second)


def test_a_feature_that_fails_has_its_default_and_says_why(specs):
    """So that a wrong path is found."""
    red = explain(specs(), "robot/r1/camera/0", b'{"rot": 1}').worth.features[0]
    assert (red.value, red.why) == (0.5, 'no field "red" in the document (it has: "rot")')
    endless = explain(specs(), "robot/r1/camera/0", b'{"red": Infinity}').worth.features[0]
    assert (endless.value, endless.why) == (0.5, "inf is no finite number")


@pytest.mark.parametrize(("function", "why"), [("leaving", "SystemExit: no"), ("cancelled", "CancelledError: late")])
def test_whatever_a_feature_raises_it_has_failed(specs, function, why):
    """Whoever asks for an explanation gets one, and in the daemon the default holds."""
    own = f'{{ kind = "python", function = "{outlooks.__name__}:{function}", default = 3.0 }}'
    loaded = specs(SPECS.replace('{ kind = "size" }', own))
    key, payload = "robot/r1/camera/0", b'{"red": 1}'
    idle = explain(loaded, key, payload).worth.features[1]
    assert (idle.value, idle.why) == (3.0, why)
    of = loaded.specs.match(key)
    assert of.extract(key, payload)[idle.name] == 3.0
    assert of.failures.counts() == {idle.name: 1}


def test_ctrl_c_in_a_feature_ends_what_measures_it(specs):
    """It is for who asked, and no failure of the feature."""
    own = f'{{ kind = "python", function = "{outlooks.__name__}:interrupted" }}'
    loaded = specs(SPECS.replace('{ kind = "size" }', own))
    key, payload = "robot/r1/camera/0", b'{"red": 1}'
    with pytest.raises(KeyboardInterrupt):
        explain(loaded, key, payload)
    with pytest.raises(KeyboardInterrupt):
        loaded.specs.match(key).extract(key, payload)


def test_expressions_without_a_value_count_as_the_daemon_counts_them(specs):
    """1 where there is none, 0 where it is below."""
    worth = explain(specs(), "robot/r1/camera/front", b'{"red": 1}').worth
    assert worth.scale.value == 1.0
    assert worth.scale.filled == "(1 + 10 * 1) / (1 + n)"
    assert "n" in worth.scale.why
    below = explain(specs(), "robot/r1/camera/0", b'{"red": -1}').worth
    assert (below.scale.value, below.scale.why, below.value) == (0.0, "is below 0", 0.0)
    assert below.scale.filled == "(1 + 10 * (-1)) / (1 + 0)"


def test_what_it_takes_of_each_limit_is_told(specs):
    """Copies count, and so does whose limit it is."""
    throughput, energy = explain(specs(), "robot/r1/x", b"x" * 12_500, receivers=2).uses
    assert (throughput.used, throughput.limit, throughput.part) == (25_000.0, 62_500.0, 0.4)
    assert throughput.rate == pytest.approx(5.0)
    assert (energy.used, energy.private, throughput.private) == (pytest.approx(0.05), True, False)
    assert explain(specs(), "robot/r1/x", b"").uses[0].rate is None
    assert explain(specs(), "robot/r1/x", b"", size=62_500).uses[0].part == 1.0


def test_a_key_that_no_type_covers_has_near_ones(specs):
    """Nothing is worked out for it."""
    found = explain(specs(SPECS.replace("robot/**", "rest/**")), "robot/r1/camra/1", b"")
    assert found.worth is None
    assert found.near[0].differences == ('"camra" is not "camera"',)
    assert found.data()["worth"] is None
    assert found.data()["near"][0]["expression"] == "robot/${robot:*}/camera/${n:*}"


def test_the_first_image_has_nothing_to_compare_with(specs):
    """The second one has, and what is no image says so."""
    loaded = specs(
        '[[information_type]]\nname = "camera"\nkeys = ["camera"]\nutility = { kind = "video" }\nscale = "change"\n'
        'features.change = { kind = "change", default = 0.25 }\n'
    )
    black, white = (cv2.imencode(".png", np.full((64, 64, 3), c, np.uint8))[1].tobytes() for c in (0, 255))

    def change(payload):
        (found,) = explain(loaded, "camera", payload).worth.features
        return found.value, found.why

    assert change(b"no image") == (0.25, "the payload is not an image")
    assert change(black) == (0.25, "there is no image before it to compare it with")
    assert change(white) == (1.0, None)


def test_a_utility_that_fails_says_so(specs):
    """The defaults of all features hold for it, as in flight."""
    loaded = specs(
        '[[information_type]]\nname = "camera"\nkeys = ["camera"]\n'
        'utility = { kind = "python", function = "tests.utility_specs.worths:by_red" }\n'
        'features.red = { kind = "json", path = "red", default = 0.5 }\n'
    )
    right = explain(loaded, "camera", b'{"red": 0.75}').worth
    assert not right.failed_utility
    assert kind_of(right.utility) == "python tests.utility_specs.worths:by_red"
    assert right.features[0].used
    wrong = explain(loaded, "camera", b'{"red": -1}').worth
    assert wrong.failed_utility
    assert wrong.lifetime.fresh == 0.5


def test_all_of_it_is_data(specs):
    """Scripts get JSON, with everything that people get."""
    data = json.loads(json.dumps(explain(specs(), "robot/r1/camera/0", b'{"red": 0.35}').data()))
    assert data["worth"]["scale"] == {
        "text": "(1 + bonus * red) / (1 + n)",
        "filled": "(1 + 10 * 0.35) / (1 + 0)",
        "value": 4.5,
        "why": None,
    }
    assert data["worth"]["utility"]["kind"] == "video"
    assert data["worth"]["covering"]["line"] == 17
    assert data["worth"]["aggregation"] == "most_recent"
    assert {each["name"]: each["rate"] for each in data["uses"]}["throughput"] > 0.0


def test_aggregations_are_named(specs):
    """The planner's own in words, too; classes by where they are."""
    assert AGGREGATIONS.keys() == set(Aggregation)
    loaded = specs(
        '[[information_type]]\nname = "a"\nkeys = ["a"]\nutility = { kind = "step", lifetime = 1 }\n'
        'aggregation = { python = "tests.utility_specs.models:Greatest" }\n'
    )
    assert combined(loaded.specs.types[0].aggregation) == "python tests.utility_specs.models:Greatest"


@pytest.mark.parametrize(
    ("value", "text"), [(4.5, "4.5"), (0.234375, "0.2344"), (1234567.0, "1234567"), (-1.0, "(-1)"), ("r1", "'r1'")]
)
def test_figures_are_written_to_be_read(value, text):
    """Whole numbers whole, others with four digits, text in quotes."""
    assert figure(value) == text


@given(st.floats(0.0, 1.0), st.sampled_from(["leader", "r2"]), st.integers(0, 9))
def test_the_factor_is_what_the_daemon_multiplies_by(loaded_once, red, robot, n):
    """For any payload and key, bit by bit."""
    key, payload = f"robot/{robot}/camera/{n}", json.dumps({"red": red}).encode()
    of = loaded_once.specs.match(key)
    assert explain(loaded_once, key, payload).worth.factor == of.scale(of.extract(key, payload))


@pytest.fixture(scope="module")
def loaded_once(tmp_path_factory):
    file = tmp_path_factory.mktemp("specs") / "specs.toml"
    file.write_text(SPECS)
    return load_set([file])
