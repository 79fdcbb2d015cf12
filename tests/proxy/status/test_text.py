"""The status as text."""

import json
from pathlib import Path

import pytest

from proxy.core.core import Core
from proxy.core.model.settings import CoreSettings
from proxy.status import text as status_text
from proxy.status.text import ALONE, SHADOWED
from utility_specs import Specs

RECORDED = [json.loads(file.read_text()) for file in sorted((Path(__file__).parent / "recorded").glob("*.json"))]


def table(status, width=None):
    return status_text.text(status, width)


def section(status):
    """The lines below the headline, without the last one, which says how to learn more."""
    return table(status).splitlines()[4:-2]


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
            "used_by_all": 100000,
            "price_per_kb": 0.0125,
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
robot r1   mode enforce   sendworthy 0.1.0   up 3 min 20 s   specs 50b2553b9f23   coordination split   \
transport unicast

samples  120 in = 70 forwarded + 49 dropped + 1 queued
  passed:no-spec   60  no spec covers its key, so nothing is decided
  dropped:planner  49  others are worth more for what room there is
  forwarded        10  it was decided on, and was worth sending

LIMIT       IN ANY  ALLOWED  USED BY ALL  OF IT   WE MAY  WE USED  1 kB COSTS  ROBOTS
throughput   0.5 s   125 kB       100 kB    80%  62.5 kB  31.2 kB      0.0125       2

decided  60 times, 300 iterations each
time     2 ms each, the longest 4.5 ms
quality  95% proven optimal, at most 0.03% of the utility lost
scarce   throughput (held) (40 drops), energy (3 drops)
last     robot/r1/camera dropped:planner 300 ms ago
         utility 3.4, of the opposite 3.28; lead 0.119, gap 0
         throughput (held) asks 0.31, energy is full
         113 iterations, 131 nodes, 2.1 ms

STREAM           ROBOT  TYPE    RHYTHM         EVERY     SIZE  VALUE  MADE  SENT  NOT SENT  SENT/S  AGE  WANTED BY
robot/r1/camera  r1     camera  periodic ±4%  100 ms  36.5 kB    3.5    60    30        30       5    -          1

FEATURE  TYPE    FAILED  OLD VALUE HELD    TAKES  BUDGET
red      camera       2              40  31.2 ms   20 ms
scale    pose         1               0        -       -

PEER  MODE    VERSION  FROM IT  FROM IT/kB   TO IT  TO IT/kB  LOST FROM  LOST TO    CLOCK   HEARD  GOT  GOT OURS
r2    shadow  0.2.0    42.1 ms        2 ms  500 ms      0 ms          -    12.5%  -3.25 s  200 ms   12        30

sendworthy status --explain says what each word means"""


def test_a_status_becomes_a_table():
    """Everything is there, aligned, with units that suit."""
    assert table(STATUS) == TABLE


def test_decisions_that_came_late_and_windows_that_were_thinned_are_told():
    """How often, and to how many messages of how many; nothing where all is in time."""
    thinned = {"windows": 2, "messages": 30, "of": 120}
    assert section({"decisions": {"made": 0, "late": 3, "thinned": thinned}}) == [
        "decided  0 times",
        "         3 were late: they were sent if they fitted",
        "thinned  2 windows, 30 of 120 messages kept",
    ]
    assert "thinned" not in table({"decisions": {"made": 1, "late": 0, "thinned": thinned | {"windows": 0}}})


def test_decisions_are_told_as_far_as_anything_is_known_of_them():
    """In shadow with what would be dropped; without bounds, times and prices nothing is said of those."""
    decisions = {"made": 2, "iterations": 20, "would_drop": 1, "last": {"key": "a", "reason": "forwarded", "age": 1.0}}
    assert section({"decisions": decisions}) == [
        "decided  2 times, 10 iterations each",
        "         1 would be dropped in enforce",
        "last     a forwarded 1 s ago",
        "         utility -, of the opposite -; lead -, gap -",
        "         0 iterations, 0 nodes, -",
    ]
    assert section({"decisions": {"made": 1, "iterations": 3}}) == ["decided  1 time, 3 iterations each"]
    assert section({"decisions": {"made": 0, "unneeded": 7, "undisputed": 5, "hopeless": 2}}) == [
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
    assert section({"kept": kept}) == [
        "kept  9 copies for robots that were away = 3 waiting + 1 dropped:expired + 5 forwarded",
        "KEPT FOR  IT IS  SINCE  COPIES",
        "r2        away     4 s       3",
    ]


def test_what_the_rules_denied_is_a_table():
    """By direction, as far as there is anything, with the bytes of what bypassed among the counts."""
    nothing = {"samples": 0, "queries": 0, "replies": 0, "subscribers": 0, "queryables": 0, "tokens": 0}
    counts = {"in": 9, "by_reason": {"dropped:denied": 2, "passed:bypass": 7}, "bytes": {"passed:bypass": 4200}}
    denied = {"out": nothing | {"samples": 2, "tokens": 12}, "in": nothing}
    assert table({"counts": counts, "daemon": {"denied": denied}}).splitlines()[2:-2] == [
        "samples  9 in = 0 forwarded + 0 dropped + 0 queued",
        "  passed:bypass   7  4.2 kB  the configuration or its type lets it bypass the planner",
        "  dropped:denied  2          the configuration keeps it on this robot",
        "",
        "DENIED  SAMPLES  QUERIES  REPLIES  SUBSCRIBERS  QUERYABLES  TOKENS",
        "out           2        0        0            0           0      12",
    ]


def test_the_status_of_a_new_core_is_short():
    """A daemon that has seen nothing yet has no empty sections."""
    core = Core(CoreSettings(robot="r1", zid="a1"), Specs.empty(), 0.0)
    lines = table(core.status(1.5)).splitlines()
    assert lines[0].startswith("robot r1   mode enforce   up 1.5 s   no specs in ")
    assert lines[1:-2] == ["", "samples  0 in = 0 forwarded + 0 dropped + 0 queued", "", ALONE]


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
        (
            {"counts": {"by_reason": {"passed:fallback": 2, "dropped:fallback": 1}}},
            "3 samples were decided without a plan, as the planner failed: see the log",
        ),
        ({"warnings": ["the disk is full"]}, "the disk is full"),
    ],
)
def test_what_is_wrong_is_said_first(change, warning):
    """Nothing that needs attention is hidden in a number."""
    assert table({**STATUS, **change}).splitlines()[2] == f"warning: {warning}"


def test_a_robot_that_takes_no_part_is_shown_as_such():
    """Whatever mode it once told."""
    peers = [STATUS["peers"][0] | {"takes_part": False, "version": None}]
    assert "\nr2    takes no part  -  " in table(STATUS | {"peers": peers})


def test_a_status_of_another_version_is_shown_as_far_as_it_goes():
    """What is missing is a dash."""
    headline = "robot r1   mode -   up -   specs -   coordination -   transport -"
    assert table({"robot": "r1"}).splitlines()[0] == headline
    assert "robot/x  -      -     -           -     -      0     0     0         0       -    -          0" in table(
        {"streams": [{"key": "robot/x"}]}
    )


def test_an_adaptive_limit_says_what_it_follows():
    """What is in force, what we think ourselves, and why."""
    adaptive = {"in_force": 0.5, "estimate": 0.55, "delay": 0.02, "reason": "free"}
    text = table({"budget": [{"constraint": "air", "adaptive": adaptive}]})
    assert "air is adaptive: 50% of its ceiling, 55% by our estimate (free, delay 20 ms)" in text


@pytest.mark.parametrize("width", [80, 100, 160])
@pytest.mark.parametrize("status", [*RECORDED, STATUS | {"warnings": ["what needs attention is long, " * 9]}])
def test_no_line_is_wider_than_the_terminal(status, width):
    """From 80 columns on; what was left out is named at the end."""
    lines = table(status, width).splitlines()
    assert max(map(len, lines)) <= width
    assert ("left out for want of room" in " ".join(lines)) == (width < 160)


@pytest.mark.parametrize("status", RECORDED)
def test_at_80_columns_what_matters_is_there(status):
    """Streams with what was made, sent and how old it is, limits with their use and price, robots with their clocks."""
    text = table(status, 80)
    for head in ("STREAM", "MADE", "SENT", "AGE", "WANTED BY", "ALLOWED", "OF IT", "1 kB COSTS", "TO IT", "CLOCK"):
        assert head in text
    assert all(stream["key"] in text for stream in status["streams"])


def test_robots_that_take_no_part_and_own_streams_come_first():
    """What is wrong, and what is ours."""
    peers = [{"robot": "a"}, {"robot": "b", "takes_part": False}]
    streams = [{"key": "1", "robot": "a"}, {"key": "2", "robot": "r"}]
    lines = table({"robot": "r", "peers": peers, "streams": streams}).splitlines()
    first = [line.split()[0] for line in lines if line]
    assert first.index("2") < first.index("1") < first.index("b") < first.index("a")


def test_what_others_call_their_things_cannot_command_the_terminal():
    """Keys and names may hold anything."""
    evil = "a\x1b[2Jb\n"
    text = table({"robot": evil, "streams": [{"key": evil}], "peers": [{"robot": evil}], "warnings": [evil]})
    assert "\x1b" not in text
    assert text.count("a\ufffd[2Jb\ufffd") == 4


def test_at_80_columns_no_count_is_cut():
    """What is told of a reason goes on in another line instead."""
    counts = STATUS["counts"] | {"by_reason": {"dropped:fallback": 1234567, "forwarded": 7}}
    lines = table(STATUS | {"counts": counts}, 80).splitlines()
    at = next(number for number, line in enumerate(lines) if "dropped:fallback" in line)
    assert lines[at] == "  dropped:fallback  1234567  the planner failed or was late, and there was no"
    assert lines[at + 1].strip() == "room"
    assert max(map(len, lines)) <= 80


def test_robots_with_other_specs_are_named():
    """As one that was off when specs were pushed; not one that has not said yet, or is of a version that does not."""
    peers = [{"robot": name, "specs": specs} for name, specs in (("r4", "1"), ("r3", "2"), ("r2", "9"), ("r5", ""))]
    shown = table({"robot": "r1", "specs": "9", "peers": [*peers, {"robot": "r6"}]}).splitlines()
    assert shown[-3] == "other specs than here: r3 (2), r4 (1)"
    assert "other specs" not in table({"robot": "r1", "specs": "9", "peers": peers[2:]})


def test_in_shadow_it_is_said_that_all_samples_go():
    """A stream has counts of what was decided, which would read otherwise."""
    assert SHADOWED in table(STATUS | {"mode": "shadow"})
    assert SHADOWED not in table(STATUS)
