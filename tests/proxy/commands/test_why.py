"""`sendworthy why` against running daemons, and against what answers strangely."""

import json
import threading
from contextlib import ExitStack

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.commands.client import NoAnswerError, connected
from proxy.commands.why import Following, pause
from proxy.why import Question
from tests.daemons import Running
from tests.proxy.nodes import closing, free_endpoint, plain_session, wait_matching
from tests.waiting import wait_until

SPECS = """
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"
window = 0.5
[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "video" }
"""


@pytest.fixture(scope="module")
def team(tmp_path_factory):
    """Two daemons whose cameras offer four times what their channel carries, until the tests are over."""
    folder = tmp_path_factory.mktemp("team")
    (folder / "specs.toml").write_text(SPECS)
    mesh = free_endpoint()
    common = ("--specs.path", str(folder), "--mode", "enforce")
    first = Running("--robot", "r1", *common, "--mesh.listen", f'["{mesh}"]')
    second = Running("--robot", "r2", *common, "--mesh.connect", f'["{mesh}"]')
    with ExitStack() as stack:
        over = threading.Event()
        for daemon in (first, second):
            stack.callback(daemon.end)
            daemon.wait_for("sendworthy ")
        apps = [closing(stack, plain_session("client", connect=(daemon.endpoint,))) for daemon in (first, second)]
        for app in apps:
            app.declare_subscriber("robot/*/camera", lambda _: None)
        for robot, app in zip(("r1", "r2"), apps, strict=True):
            wait_matching(app, f"robot/{robot}/camera")

        def film():
            while not over.wait(0.1):
                for robot, app in zip(("r1", "r2"), apps, strict=True):
                    app.put(f"robot/{robot}/camera", bytes(26_000))

        filming = threading.Thread(target=film)
        filming.start()
        stack.callback(filming.join)
        stack.callback(over.set)
        yield first, second


def dropped(daemon, robot="r1"):
    """Return the answer that has a sample which the planner dropped in contention with the other robot."""
    found = []

    def looked():
        with connected(daemon.endpoint) as client:
            answer = client.why(robot, Question("camera", 16))
        for stream in answer["streams"]:
            found.extend(
                each
                for each in stream["decisions"]
                if each["reason"] == "dropped:planner" and each["search"] and each["search"]["competitors"]
            )
        return found

    wait_until(looked, what="a drop under contention")
    return found[-1]


def test_a_drop_under_contention_is_told_with_what_it_competed_with(team):
    """The other robot's camera; the numbers are those of a plan that drops it."""
    each = dropped(team[0])
    search = each["search"]
    assert not each["sent"]
    assert not search["send"]
    assert [(rival["robot"], rival["key"]) for rival in search["competitors"]] == [("r2", "robot/r2/camera")]
    assert search["competitors"][0]["worth"] > 0.0
    assert search["own"]["key"] == "robot/r1/camera"
    assert search["without"] is not None
    if search["with"] is not None:
        assert search["difference"] == pytest.approx(search["with"] - search["without"])
        assert search["lead"] <= 1e-9
    assert 1 <= search["iterations"] <= search["allowed"]


def test_people_get_words_and_scripts_json(team, capsys):
    """Of the same decisions, in 80 columns."""
    dropped(team[0])
    assert main(["why", "robot/r1/camera", "--last", "16", "--connect", team[0].endpoint]) == exit_codes.OK
    out = capsys.readouterr().out
    assert out.startswith("robot/r1/camera of robot r1\n  type camera; mode enforce; wanted by 1 robot; ")
    assert "DROPPED: others are worth more for what is left (dropped:planner)" in out
    assert "the team gains" in out
    assert "robot/r2/camera of r2" in out
    assert max(map(len, out.splitlines())) <= 80
    assert main(["why", "robot/*/camera", "--json", "--robot", "r1", "--connect", team[0].endpoint]) == exit_codes.OK
    answer = json.loads(capsys.readouterr().out)
    assert (answer["version"], answer["robot"]) == (1, "r1")
    assert 1 <= len(answer["streams"][0]["decisions"]) <= 3


def test_a_key_of_another_robot_is_asked_for_there(team, capsys):
    """It says so, once it knows the other robot's streams."""
    assert dropped(team[0])
    assert main(["why", "robot/r2/camera", "--connect", team[0].endpoint]) == exit_codes.FAILED
    assert "whose own daemon decides on it" in capsys.readouterr().err


def test_unknown_keys_and_a_daemon_that_goes_away_are_told(start, tmp_path, capsys):
    """As clear errors."""
    (tmp_path / "specs.toml").write_text(SPECS)
    daemon = start("--robot", "r9", "--specs.path", str(tmp_path), "--mode", "enforce")
    daemon.wait_for("sendworthy ")
    with connected(daemon.endpoint) as client:
        assert main(["why", "camera", "--connect", daemon.endpoint]) == exit_codes.FAILED
        assert 'no decision was made on "camera"' in capsys.readouterr().err
        daemon.end()
        with pytest.raises(NoAnswerError, match='no daemon of robot "r9" answers'):
            client.why("r9", Question("camera"))


def answer_of(*decisions, key="a", decided=9):
    stream = {"robot": "r1", "key": key, "type": "t", "mode": "enforce", "decisions": list(decisions)}
    return {"decided": decided, "streams": [stream]}


def decision(nth, count=1, age=0.0):
    return {"nth": nth, "count": count, "age": age, "reason": "forwarded", "cause": "unneeded", "sent": True}


def test_following_tells_each_decision_once():
    """How many more are like the last one, and how many came too fast."""
    following = Following(as_json=False)
    assert list(following.news(answer_of(decision(3, 2)), 80))[-1].endswith(
        "a: 2 samples SENT: there was room for all (forwarded)"
    )
    (more,) = following.news(answer_of(decision(5, 4)), 80)
    assert more.endswith("a: 2 more: SENT: there was room for all (forwarded)")
    lines = list(following.news(answer_of(decision(9)), 80))
    assert lines[0] == "(3 decisions on a in between came too fast to be shown)"
    following.restarted()
    assert next(following.news(answer_of(decision(1)), 80)).startswith("a of robot r1")


def test_following_as_json_gives_a_decision_a_line():
    """With its stream and the version."""
    (line,) = Following(as_json=True).news(answer_of(decision(1)), 80)
    assert json.loads(line) == {"version": 1, "robot": "r1", "key": "a", **decision(1)}


@pytest.mark.parametrize(("rate", "wait"), [(0, 2.0), (10, 1.2), (24, 0.5), (60, 0.2), (1000, 0.1)])
def test_the_more_is_decided_the_sooner_it_is_asked_again(rate, wait):
    """Before the daemon forgets any of the last 16 decisions on a stream, where that can be."""
    last = 1.0
    for _ in range(30):
        many = [decision(nth) for nth in range(min(16, round(rate * last)))]
        last = pause(answer_of(*many), last)
    assert last == pytest.approx(wait, rel=0.1)


def test_following_goes_on_until_nobody_answers(stand_in, capsys, monkeypatch):
    """New decisions as they come; a daemon that began anew is followed, too."""
    monkeypatch.setattr("proxy.commands.why.MOST_PAUSE", 0.0)
    asked = []
    answers = [
        answer_of(decision(1), decided=1),
        answer_of(decided=1),
        answer_of(decision(1), decided=0),
        {"decided": 0, "streams": [], "problem": "gone"},
    ]

    def tell(query):
        asked.append(json.loads(bytes(query.payload)))
        query.reply("@sendworthy/r1/why", json.dumps(answers[len(asked) - 1]))
        query.drop()

    where = stand_in({"@sendworthy/r1/why": tell})
    assert main(["why", "a", "--follow", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    caught = capsys.readouterr()
    assert [each["after"] for each in asked] == [0, 1, 1, 0]
    assert caught.out.count("SENT: there was room for all") == 2
    assert caught.err == "sendworthy why: robot r1: gone\n"


def test_nothing_decided_and_streams_left_out_are_told(stand_in, capsys):
    """An answer may have both."""

    def tell(query):
        query.reply("@sendworthy/r1/why", json.dumps(answer_of() | {"left_out": ["b", "\x1b[31mc"]}))
        query.drop()

    where = stand_in({"@sendworthy/r1/why": tell})
    assert main(["why", "a", "--robot", "r1", "--connect", where]) == exit_codes.OK
    out = capsys.readouterr().out
    assert "nothing was decided on it yet" in out
    assert "and 2 more streams: b, \ufffd[31mc" in out


@pytest.mark.parametrize("told", [[], {"streams": [5]}, answer_of({"age": "old"}), answer_of(decision(1, age=10**400))])
@pytest.mark.parametrize("flags", [(), ("--follow",)])
def test_what_is_no_answer_is_no_daemon(stand_in, capsys, told, flags):
    """Of this version, or another program."""

    def tell(query):
        query.reply("@sendworthy/r1/why", json.dumps(told))
        query.drop()

    where = stand_in({"@sendworthy/r1/why": tell})
    assert main(["why", "a", "--robot", "r1", "--connect", where, *flags]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy why: what answers at {where} is no daemon of this version\n"


def test_two_daemons_of_one_name_are_told(stand_in, capsys):
    """Whose decisions would these be?"""

    def tell(query):
        for _ in range(2):
            query.reply("@sendworthy/r1/why", json.dumps(answer_of()))
        query.drop()

    where = stand_in({"@sendworthy/r1/why": tell})
    assert main(["why", "a", "--robot", "r1", "--connect", where]) == exit_codes.FAILED
    assert "2 daemons called r1 answer" in capsys.readouterr().err


def test_too_many_decisions_are_refused(capsys):
    """Before anybody is asked."""
    assert main(["why", "a", "--last", "17"]) == exit_codes.USAGE
    assert "the last 1 to 16 decisions" in capsys.readouterr().err
