"""What could matter in samples."""

import pytest

from tests.utility_specs.learning.team import json_bytes, picture, regular, streams_of
from utility_specs.learning.candidates import MOST_WORDS, candidates_of


def found(*documents, rate=1.0):
    """What is found in one stream of these documents."""
    return candidates_of(streams_of(regular("k", rate, lambda i: json_bytes(**documents[i]), len(documents) / rate)))


def test_what_varies_is_a_candidate_what_varies_most_first():
    """With the table of a feature, and the values seen."""
    charge, alarm = found(*({"charge": 0.5 + 0.01 * i, "alarm": i > 7} for i in range(10))).candidates[::-1]
    assert (charge.name, charge.table) == ("charge", 'kind = "json", path = "charge"')
    assert charge.values[:2] == [0.5, 0.51]
    assert alarm.name == "alarm"
    assert alarm.variation > charge.variation > 0.0


@pytest.mark.parametrize(
    ("value", "why"),
    [
        (lambda _: 7, "constant"),
        (lambda _: "text", "constant"),
        (lambda i: 1e6 + i / 100, "constant"),
        (lambda i: i, "counts"),
        (lambda i: 3 * i + 7, "counts"),
        (lambda i: 1.7e9 + i, "time"),
        (lambda i: 1.7e18 + 1e9 * i, "time"),
        (lambda i: f"name {i}", "text"),
    ],
)
def test_what_tells_nothing_is_left_out(value, why):
    """And why is said."""
    assert found(*({"x": value(i)} for i in range(10))).left_out == (("x", why),)


@pytest.mark.parametrize(
    "value",
    [lambda i: i + 0.5, lambda i: -i, lambda i: i // 5, lambda i: 1.0 * i + 0.25 * (i % 2)],
)
def test_what_only_looks_like_a_clock_is_a_candidate(value):
    """A robot may move at 1 m/s, a charge falls, an error is counted now and then."""
    assert [each.name for each in found(*({"x": value(i)} for i in range(10))).candidates] == ["x"]


def test_a_few_samples_count_nothing():
    """Three numbers may rise by chance."""
    assert found({"x": 1}, {"x": 2}, {"x": 3}).candidates


def test_stamps_are_times_by_their_name():
    """Nanoseconds begin anew each second."""
    documents = [{"stamp": {"sec": i, "nanosec": i * 377 % 1000}} for i in range(10)]
    assert {why for _, why in found(*documents).left_out} == {"time"}


def test_states_are_compared_with_the_rarest():
    """With few words; where there are many, they are names."""
    (state,) = found(*({"state": "lost" if i == 3 else "ok"} for i in range(10))).candidates
    assert (state.name, state.table) == ("state_lost", 'kind = "json", path = "state", equals = "lost"')
    assert sum(state.values) == 1.0
    assert not found(*({"state": "abcdefgh"[i % (MOST_WORDS + 1)]} for i in range(12))).candidates


def test_numbers_of_each_stream_are_judged_alone():
    """What is constant in each is constant, though it differs between them; what varies in one varies."""
    streams = streams_of(*(regular(f"r{n}", 1.0, lambda _, n=n: json_bytes(id=n), 10.0) for n in (1, 2)))
    assert candidates_of(streams).left_out == (("id", "constant"),)
    streams = streams_of(
        regular("r1", 1.0, lambda _: json_bytes(x=1), 10.0), regular("r2", 1.0, lambda i: json_bytes(x=-i), 10.0)
    )
    assert [each.name for each in candidates_of(streams).candidates] == ["x"]


def test_words_and_numbers_in_one_place_are_compared():
    """A number is none of the words."""
    (mixed,) = found(*({"x": "none" if i == 2 else i} for i in range(5))).candidates
    assert mixed.values == [0.0, 0.0, 1.0, 0.0, 0.0]


def test_lengths_that_never_change_are_not_even_named():
    """Of arrays with always as many elements."""
    seen = found(*({"p": [i % 2, 1]} for i in range(5)))
    assert ([each.name for each in seen.candidates], seen.left_out) == (["p_0"], (("p[1]", "constant"),))


def test_images_show_colours():
    """Those that vary by more than noise."""
    (stream,) = streams_of(regular("k", 1.0, lambda i: picture(0.5 * (i % 2)), 6.0))
    seen = candidates_of([stream])
    assert {"red", "change"} >= {each.name for each in seen.candidates if each.name != "brightness"} > {"red"} - {"red"}
    assert seen.candidates[0].table == 'kind = "color_fraction", color = "red"'
    assert ("green", "constant") in seen.left_out
