"""The status as a table."""

import pytest

from proxy.core.core import Core
from proxy.core.model.settings import CoreSettings
from proxy.status_table import ALONE, amount, duration, rate, schedule, share, table
from utility_specs import Specs

STATUS = {
    "version": "0.1.0",
    "robot": "r1",
    "mode": "enforce",
    "specs": "50b2553b9f23",
    "coordination": "split",
    "transport": "unicast",
    "uptime": 200.0,
    "counts": {
        "in": 120,
        "forwarded": 70,
        "dropped": 49,
        "queued": 1,
        "conserved": True,
        "by_reason": {"dropped:planner": 49, "forwarded": 10, "passed:no-spec": 60},
    },
    "decisions": {
        "made": 60,
        "iterations": 18000,
        "would_drop": 0,
        "seconds": 0.12,
        "longest": 0.0045,
        "proven": 57,
        "bounded": 60,
        "gap": 0.05,
        "utility": 200.0,
        "binding": {"throughput (held)": 40, "energy": 3},
        "last": {
            "age": 0.3,
            "key": "robot/r1/camera",
            "send": False,
            "reason": "dropped:planner",
            "utility": 3.4,
            "opposite": 3.281,
            "lead": 0.1193,
            "gap": 0.0,
            "iterations": 113,
            "nodes": 131,
            "seconds": 0.0021,
            "binding": ["throughput (held)", "energy"],
            "prices": {"throughput": 0.0, "throughput (held)": 0.31, "energy": 0.0},
        },
    },
    "budget": [
        {
            "constraint": "throughput",
            "window": 0.5,
            "limit": 125000.0,
            "held": 62500.0,
            "used": 31250,
            "members": 2,
        }
    ],
    "streams": [
        {
            "robot": "r1",
            "key": "robot/r1/camera",
            "type": "camera",
            "schedule": "periodic",
            "period": 0.1,
            "jitter": 0.004,
            "size": 36500,
            "scale": 3.5,
            "generated": 60,
            "forwarded": 30,
            "receivers": 1,
        }
    ],
    "features": [
        {"type": "camera", "feature": "red", "failed": 2, "held": 40, "cost": 0.0312, "budget": 0.02},
        {"type": "camera", "feature": "size", "failed": 0, "held": 0, "cost": 1e-6, "budget": 0.02},
        {"type": "pose", "feature": "scale", "failed": 1, "held": 0, "cost": None, "budget": None},
    ],
    "peers": [
        {
            "robot": "r2",
            "version": "0.2.0",
            "mode": "shadow",
            "latency_in": {"fixed": 0.0421, "per_byte": 2e-6},
            "latency_out": {"fixed": 0.5, "per_byte": 0.0},
            "loss_in": None,
            "loss_out": 0.125,
            "wall_ahead": -3.25,
            "digest_age": 0.2,
            "samples": 12,
            "received_of_ours": 30,
        }
    ],
    "malformed": 0,
    "evicted": 0,
}

TABLE = """\
robot r1   mode enforce   specs 50b2553b9f23   coordination split   transport unicast   \
up 3 min 20 s   sendworthy 0.1.0

samples  120 in = 70 forwarded + 49 dropped + 1 queued
  passed:no-spec   60
  dropped:planner  49
  forwarded        10

decided  60 times, 300 iterations each
time     2 ms each, the longest 4.5 ms
quality  95% proven optimal, at most 0.03% of the utility lost
scarce   throughput (held) (40 drops), energy (3 drops)
last     robot/r1/camera dropped:planner 300 ms ago
         utility 3.4, of the opposite 3.28; lead 0.119, gap 0
         throughput (held) asks 0.31, energy is full
         113 iterations, 131 nodes, 2.1 ms

BUDGET      WINDOW   LIMIT     OURS          USED       ROBOTS
throughput   0.5 s  125 kB  62.5 kB  50%  31.2 kB  25%       2

STREAM           ROBOT  TYPE    SCHEDULE      PERIOD     SIZE  SCALE  MADE  SENT  UNSENT  SENT/S  WANTED BY
robot/r1/camera  r1     camera  periodic ±4%  100 ms  36.5 kB    3.5    60    30      30       5          1

FEATURE  TYPE    FAILED  OLD VALUE HELD    TAKES  BUDGET
red      camera       2              40  31.2 ms   20 ms
scale    pose         1               0        -       -

PEER  MODE    VERSION            FROM IT   TO IT  LOST IN    OUT    CLOCK   HEARD  GOT  GOT OURS
r2    shadow  0.2.0    42.1 ms + 2 ms/kB  500 ms        -  12.5%  -3.25 s  200 ms   12        30"""


def test_a_status_becomes_a_table():
    """Everything is there, aligned, with units that suit."""
    assert table(STATUS) == TABLE


def test_decisions_that_came_late_and_windows_that_were_thinned_are_told():
    """How often, and to how many messages of how many; nothing where all is in time."""
    thinned = {"windows": 2, "messages": 30, "of": 120}
    assert table({"decisions": {"made": 0, "late": 3, "thinned": thinned}}).splitlines()[4:] == [
        "decided  0 times",
        "         3 were late: they were sent if they fitted",
        "thinned  2 windows, 30 of 120 messages kept",
    ]
    assert "thinned" not in table({"decisions": {"made": 1, "late": 0, "thinned": thinned | {"windows": 0}}})


def test_decisions_are_told_as_far_as_anything_is_known_of_them():
    """In shadow with what would be dropped; without bounds, times and prices nothing is said of those."""
    decisions = {"made": 2, "iterations": 20, "would_drop": 1, "last": {"key": "a", "reason": "forwarded", "age": 1.0}}
    assert table({"decisions": decisions}).splitlines()[4:] == [
        "decided  2 times, 10 iterations each",
        "         1 would be dropped in enforce",
        "last     a forwarded 1 s ago",
        "         utility -, of the opposite -; lead -, gap -",
        "         0 iterations, 0 nodes, -",
    ]
    assert table({"decisions": {"made": 1, "iterations": 3}}).splitlines()[4:] == [
        "decided  1 times, 3 iterations each"
    ]
    assert table({"decisions": {"made": 0, "unneeded": 7, "undisputed": 5, "hopeless": 2}}).splitlines()[4:] == [
        "decided  0 times",
        "         7 more samples went while there was room for all",
        "         5 more samples went as they earn what room costs",
        "         2 were dropped as they do not earn what room costs",
    ]


def test_what_is_kept_for_robots_that_are_away_is_a_table():
    """All copies are accounted for, and whoever they wait for is named."""
    kept = {
        "in": 9,
        "waiting": 3,
        "conserved": True,
        "by_reason": {"dropped:expired": 1, "forwarded": 5},
        "for": [{"robot": "r2", "back": False, "away": 4.0, "samples": 3}],
    }
    assert table({"kept": kept}).splitlines()[4:] == [
        "kept  9 copies for robots that were away = 3 waiting + 1 dropped:expired + 5 forwarded",
        "KEPT FOR        SINCE  COPIES",
        "r2        away    4 s       3",
    ]


def test_what_the_rules_denied_is_a_table():
    """By direction, as far as there is anything, with the bytes of what bypassed among the counts."""
    nothing = {"samples": 0, "queries": 0, "replies": 0, "subscribers": 0, "queryables": 0, "tokens": 0}
    counts = {"in": 9, "by_reason": {"dropped:denied": 2, "passed:bypass": 7}, "bytes": {"passed:bypass": 4200}}
    denied = {"out": nothing | {"samples": 2, "tokens": 12}, "in": nothing}
    assert table({"counts": counts, "daemon": {"denied": denied}}).splitlines()[2:] == [
        "samples  9 in = 0 forwarded + 0 dropped + 0 queued",
        "  passed:bypass   7  4.2 kB",
        "  dropped:denied  2",
        "",
        "DENIED  SAMPLES  QUERIES  REPLIES  SUBSCRIBERS  QUERYABLES  TOKENS",
        "out           2        0        0            0           0      12",
    ]


def test_the_status_of_a_new_core_is_short():
    """A daemon that has seen nothing yet has no empty sections."""
    core = Core(CoreSettings(robot="r1", zid="a1"), Specs.empty(), 0.0)
    lines = table(core.status(1.5)).splitlines()
    assert lines[0].startswith("robot r1   mode enforce   no specs in ")
    assert lines[0].endswith("up 1.5 s")
    assert lines[1:] == ["", "samples  0 in = 0 forwarded + 0 dropped + 0 queued", "", ALONE]


@pytest.mark.parametrize(
    ("change", "warning"),
    [
        ({"counts": {"conserved": False}}, "the counts do not add up: please report this"),
        ({"malformed": 3}, "3 malformed messages on Sendworthy's keys were ignored"),
        (
            {"malformed": 3, "refused": {"digest:old": 1, "state:forged": 2}},
            "3 malformed messages on Sendworthy's keys were ignored (1 digest:old, 2 state:forged)",
        ),
        (
            {"malformed": 1, "refused": {"digest:malformed": 1, "digest:flood": 9, "digest:other version": 9}},
            "1 malformed messages on Sendworthy's keys were ignored (1 digest:malformed)",
        ),
        ({"other_version": 4}, "4 messages of another version of Sendworthy were not understood"),
        ({"untold": 7}, "7 streams, subscriptions or origins are too many to tell the others"),
        ({"daemon": {"refused": 9}}, "9 messages of other robots came faster than they could be taken in"),
        ({"evicted": 2}, "2 streams or robots were forgotten: there are too many"),
        ({"daemon": {"faults": 1}}, "internal errors: 1, see the log"),
        ({"warnings": ["the disk is full"]}, "the disk is full"),
    ],
)
def test_what_is_wrong_is_said_at_the_end(change, warning):
    """Nothing that needs attention is hidden in a number."""
    assert table({**STATUS, **change}).splitlines()[-1] == f"warning: {warning}"


def test_a_robot_that_takes_no_part_is_shown_as_such():
    """Whatever mode it once told."""
    peers = [STATUS["peers"][0] | {"takes_part": False, "version": None}]
    assert "\nr2    takes no part  -  " in table(STATUS | {"peers": peers})


def test_a_status_of_another_version_is_shown_as_far_as_it_goes():
    """What is missing is a dash."""
    headline = "robot r1   mode -   specs -   coordination -   transport -   up -"
    assert table({"robot": "r1"}).splitlines()[0] == headline
    assert "robot/x  -      -     -              -     -      0     0     0       0       -          0" in table(
        {"streams": [{"key": "robot/x"}]}
    )


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (None, "-"),
        (0.0, "0 ms"),
        (0.0125, "12.5 ms"),
        (-0.5, "-500 ms"),
        (1.5, "1.5 s"),
        (61.0, "1 min 1 s"),
        (7260.0, "2 h 1 min"),
    ],
)
def test_durations_have_units_that_suit(seconds, text):
    """Milliseconds below a second, minutes and hours above a minute."""
    assert duration(seconds) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (0, "0 B"), (999, "999 B"), (1000, "1 kB"), (2.5e6, "2.5 MB"), (3e9, "3 GB")],
)
def test_amounts_have_prefixes(value, text):
    """Three digits are enough."""
    assert amount(value, "B") == text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.2, "s", "200 ms"),
        (0.00025, "s", "250 μs"),
        (0, "J", "0 J"),
        (0.0015, "J", "1.5 mJ"),
        (12.5, "J", "12.5 J"),
        (9.8, "messages", "9.8 messages"),
    ],
)
def test_amounts_of_small_units_have_small_prefixes(value, unit, text):
    """Airtime and energy come in thousandths, messages as they are."""
    assert amount(value, unit) == text


def test_shares_and_rates_need_something_to_divide_by():
    """What is not known is a dash, not a zero."""
    assert share(1.0, 4.0) == "25%"
    assert share(1.0, None) == share(None, 1.0) == "-"
    assert rate({"period": 0.5, "generated": 10, "forwarded": 5}) == "1"
    assert rate({"period": 0.0, "generated": 10, "forwarded": 5}) == "-"
    assert rate({"period": 0.5, "generated": 10, "forwarded": 5, "over": True}) == "0"


def test_a_schedule_says_how_exactly_it_is_kept():
    """Where there is a period to keep; other kinds are told by name alone."""
    assert schedule({"schedule": "periodic", "period": 0.5, "jitter": 0.05}) == "periodic ±10%"
    assert schedule({"schedule": "bursts 5 0.05", "period": 0.4, "jitter": 0.1}) == "bursts of 5"
    assert schedule({"schedule": "periodic", "period": 0.5, "jitter": 0.05, "over": True}) == "over"
    assert schedule({"schedule": "", "period": 0.0, "jitter": 0.0}) == schedule({}) == "-"


def test_an_adaptive_limit_says_what_it_follows():
    """What is in force, what we think ourselves, and why."""
    adaptive = {"in_force": 0.5, "estimate": 0.55, "delay": 0.02, "reason": "free"}
    text = table({"budget": [{"constraint": "air", "adaptive": adaptive}]})
    assert "air is adaptive: 50% of its ceiling, 55% by our estimate (free, delay 20 ms)" in text
