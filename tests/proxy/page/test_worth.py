"""What streams are worth to who watches."""

import pytest

from proxy.page.specs import InForce
from proxy.page.worth import Worth, marked, worth

TEXT = """\
[[information_type]]
name = "camera"
keys = ["camera/*"]
aggregation = "{aggregation}"
utility = {{ kind = "linear", slope = 0.1 }}
scale = "1 + 10 * red"
features.red = {{ kind = "color_fraction", color = "red" }}

[[information_type]]
name = "alarm"
keys = ["alarm"]
aggregation = "sum"
utility = {{ kind = "step", lifetime = "1 min" }}
"""
STREAM = {"key": "camera/a", "scale": 5.0, "last_generated": 1.0, "shown": 5.0, "age": 2.0, "receivers": 1}


def specs(aggregation="current"):
    found = InForce.of("g", {"a.toml": TEXT.format(aggregation=aggregation)})
    assert not found.problem
    return found.specs


@pytest.mark.parametrize(
    ("aggregation", "more", "expected"),
    [
        ("current", {}, Worth(4.0, 4.5)),
        # 5 · 0.8 for what is shown, less 1 · 4 for as much as it shows too much; 1 · 0.9 could be there.
        ("current", {"scale": 1.0}, Worth(0.0, 0.9)),
        ("current", {"scale": 0.0}, Worth(-1.0, 0.0)),
        ("most_recent", {"scale": 1.0}, Worth(4.0, 4.0)),
        ("current", {"shown": None, "age": None}, Worth(0.0, 4.5)),
    ],
)
def test_worth_falls_with_age_and_with_what_is_no_longer_true(aggregation, more, expected):
    """By MODEL.md 3, against what would be there had all arrived at once."""
    found = worth(specs(aggregation), STREAM | more)
    assert (found.now, found.most) == pytest.approx((expected.now, expected.most))


@pytest.mark.parametrize(
    "more", [{"key": "pose"}, {"key": "alarm"}, {"receivers": 0}, {"scale": None}, {"last_generated": None}]
)
def test_what_is_not_known_is_none(more):
    """Without a type, where each sample counts, where nobody wants it, or an older daemon tells less."""
    assert worth(specs(), STREAM | more) is None


def test_what_is_worth_much_more_than_usual_is_marked():
    """From twice the usual on."""
    assert marked(specs(), STREAM)
    assert marked(specs(), STREAM | {"scale": 2.0})
    assert not marked(specs(), STREAM | {"scale": 1.9})
    assert not marked(specs(), STREAM | {"key": "pose"})
