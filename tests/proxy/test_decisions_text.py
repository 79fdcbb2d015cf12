"""Decisions in words."""

import pytest

from proxy.decisions_text import again, described, headed

SEARCH = {
    "send": False,
    "with": 5.35,
    "without": 5.42,
    "difference": -0.07,
    "lead": -0.05,
    "earns": 0.31,
    "price": 0.38,
    "prices": {"air": 0.38, "energy": 0.0},
    "binding": ["air"],
    "gap": 0.0,
    "proven": True,
    "iterations": 131,
    "allowed": 300,
    "cut": False,
    "nodes": 40,
    "seconds": 0.0041,
    "messages": 14,
    "messages_of": 14,
    "own": {"robot": "r1", "key": "robot/r1/camera", "worth": 0.93, "size": 26000, "messages": 3, "sent": 1},
    "competitors": [
        {"robot": "r2", "key": "robot/r2/camera", "worth": 2.1, "size": 26000, "messages": 3, "sent": 2},
        {"robot": "r1", "key": "robot/r1/" + "long/" * 20 + "map", "worth": 1.0, "size": 0, "messages": 8, "sent": 0},
    ],
    "more": 2,
}
DROPPED = {
    "count": 1,
    "reason": "dropped:planner",
    "cause": "search",
    "sent": False,
    "shadowed": False,
    "lacking": [],
    "beside": "",
    "copy_to": None,
    "size": 26100,
    "worth": 0.93,
    "decided_at_age": 0.035,
    "market": None,
    "search": SEARCH,
}


def text(decision, width=80):
    lines = list(described(decision, "1 s ago", width))
    assert all(len(line) <= width for line in lines)
    return "\n".join(lines)


def test_a_drop_is_explained_whole():
    """What it competed with, both plans, the price, what is scarce, and how sure that is, in 80 columns."""
    assert text(DROPPED).splitlines() == [
        "1 s ago: DROPPED: others are worth more for what is left (dropped:planner)",
        "  sample      26.1 kB, worth 0.93 in its first second; decided 35 ms after it",
        "              was made",
        "  best plans  the team gains 5.35 with it and 5.42 without it: 0.07 less with",
        "              it; counting what follows the planned time, 0.05 less",
        "  price       its room costs 0.38; it would add 0.31 to the best plan that sends",
        "              it",
        "  scarce      air",
        "  certainty   proven, no plan is better; 131 of 300 iterations in 4.1 ms",
        "  beside      what else waits or is expected, its worth, and how many are sent",
        "              STREAM                         WORTH   SIZE  PER kB    SENT",
        "              its own next ones               0.93  26 kB  0.0358  1 of 3",
        "              robot/r2/camera of r2            2.1  26 kB  0.0808  2 of 3",
        "              robot/r1/…/long/long/long/map      1    0 B       -  0 of 8",
        "              and 2 more streams",
    ]
    assert "counting what follows" in text(DROPPED, 160).splitlines()[2]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            {"with": None, "difference": None, "lead": None, "earns": None},
            "gains 5.42 without it; no plan was found that",
        ),
        ({"without": None, "difference": None}, "gains 5.35 with it; no plan was found that drops it"),
        ({"difference": 0.0, "lead": 0.0}, "the same with it"),
        ({"prices": {}}, "room is free; it would add 0.31"),
        ({"earns": -0.2}, "it would take 0.2 from"),
        ({"send": True, "earns": -0.2}, "it takes 0.2 from"),
        ({"send": True}, "it adds 0.31 to"),
        ({"prices": {"air": 0.3, "energy": 0.08}}, "its room costs 0.38 (air 0.3, energy 0.08)"),
        ({"binding": []}, "no limit"),
        ({"proven": False, "gap": 0.1}, "no plan is better by more than 0.1 (1.8%)"),
        ({"proven": False, "gap": None}, "by how much others may be better is not known"),
        ({"cut": True}, "cut short by the deadline"),
        ({"seconds": None}, "131 of 300 iterations"),
        ({"messages_of": 60}, "14 of 60 messages were looked at, to be done in time"),
        ({"own": {}, "competitors": []}, "nothing else competes with it"),
        ({"more": 1}, "and 1 more stream"),
    ],
)
def test_every_state_of_a_search_has_words(changed, said):
    """Whatever is not known."""
    assert said in " ".join(text({**DROPPED, "search": SEARCH | changed}).split())


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            {"shadowed": True, "sent": True},
            "would be dropped in enforce, sent in shadow: others are worth more",
        ),
        (
            {"reason": "forwarded", "cause": "unneeded", "sent": True, "count": 7},
            "7 samples SENT: there was room for all",
        ),
        ({"reason": "dropped:superseded", "cause": "", "size": None}, "DROPPED: a newer one came before its turn"),
        ({"reason": "waits", "cause": "search"}, "WAITS: its room may just be taken"),
        ({"reason": "waits", "cause": "", "copy_to": "r3"}, "copy for r3, which was away, WAITS"),
        (
            {"reason": "dropped:constraint", "cause": "", "lacking": ["air"]},
            "air has no room for it beside what was sent",
        ),
        ({"lacking": ["air"], "beside": "booked"}, "kept for streams that are always sent"),
        ({"lacking": ["air"], "beside": "rivals"}, "a robot whose sample is worth more may just be sending"),
        ({"decided_at_age": 0.0}, "decided at once"),
        ({"worth": None, "decided_at_age": None}, "sample 26.1 kB best"),
    ],
)
def test_every_fate_has_words(changed, said):
    """Those of the other commands, as far as they have them."""
    assert said in " ".join(text(DROPPED | changed).split())


@pytest.mark.parametrize(
    ("standing", "said"),
    [
        ("undisputed", "the room of one costs 0.1, and each earns at least 0.2 though all are sent, one every 1 s"),
        ("hopeless", "and even the first in a long time would earn only 0.3"),
        ("priced", "at that it pays to send one every 4 s, of one every 1 s"),
    ],
)
def test_what_room_costs_is_told_where_it_decided(standing, said):
    """Without a search."""
    market = {"standing": standing, "price": 0.1, "least": 0.2, "most": 0.3, "every": 4.0, "interval": 1.0}
    assert said in " ".join(text({**DROPPED, "search": None, "market": market}).split())
    assert "at present" not in text({**DROPPED, "search": None, "market": market | {"price": 0.0}})


def test_a_stream_is_headed_by_what_is_known_of_it():
    """And by what is undecided."""
    stream = {
        "key": "a/b",
        "robot": "r1",
        "type": "camera",
        "mode": "shadow",
        "receivers": 2,
        "generated": 9,
        "forwarded": 9,
        "undecided": [
            {"age": 0.1, "size": 1000, "deciding": True, "opens_in": None},
            {"age": 0.2, "size": 1000, "deciding": False, "opens_in": 0.05},
            {"age": 0.3, "size": 1000, "deciding": False, "opens_in": None},
        ],
    }
    assert list(headed(stream, 120)) == [
        "a/b of robot r1",
        "  type camera; mode shadow: it decides, but sends all; wanted by 2 robots; 9 made, 9 sent, 0 not",
        "  a sample of 1 kB that is 100 ms old is being decided",
        "  a sample of 1 kB that is 200 ms old waits for room, for 50 ms at least",
        "  a sample of 1 kB that is 300 ms old waits",
    ]
    assert "no type of the specs in force plans for it" in "\n".join(headed({**stream, "type": None}, 80))


def test_the_same_again_is_one_line():
    """In which it says how many more."""
    assert list(again(DROPPED, 12, "now", 100)) == [
        "now: 12 more: DROPPED: others are worth more for what is left (dropped:planner)"
    ]


def test_what_a_sample_ends_is_said():
    """With `current`: what was sent last shows too much."""
    ending = {**DROPPED, "search": {**SEARCH, "ends": 4.0}}
    assert "and it ends a loss of 4 a second: what was sent last shows too much" in text(ending, 200)
    assert "ends a loss" not in text({**DROPPED, "search": {**SEARCH, "ends": 0.0}}, 200)
