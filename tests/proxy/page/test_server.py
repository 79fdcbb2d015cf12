"""The page's server with a real fleet: what it shows, what it changes, and what it bears."""

import json
import socket
from contextlib import ExitStack

import pytest

from proxy.page.tuning import TUNING
from tests.pages import SPECS, Fleet, Served
from tests.waiting import wait_until


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """An operator's daemon and a robot with a camera for whose images there is half the room."""
    with ExitStack() as closing:
        made = Fleet(tmp_path_factory.mktemp("fleet"), closing, robots=1, limit="150 kbit/s", hz=10)
        made.page = Served("--connect", made.ground.endpoint, "--connect", made.robots[0].endpoint)
        closing.callback(made.page.end)
        yield made


@pytest.fixture
def live(fleet):
    """The stream that a browser reads."""
    stream = fleet.page.live()
    yield stream
    stream.close()


def camera(head):
    """What a status says of the camera of r1."""
    rows = [each for robot in head.get("robots", ()) if robot["robot"] == "r1" for each in robot["types"]]
    return rows[0] if rows else None


def test_images_come_untouched_with_rate_and_age(fleet, live):
    """The bytes that the camera published; the first messages tell of the past."""
    head, body = live.next()
    assert head["kind"] == "history"
    assert body == b""
    head, body = live.until(lambda head, _: head["kind"] == "frame" and head["rate"] > 0.0)
    assert (head["key"], head["type"]) == ("robot/r1/camera", "image/jpeg")
    assert body in fleet.cameras[0]._plain
    assert 0.0 <= head["age"] < 60.0


@pytest.mark.full
def test_what_is_dropped_is_told_with_the_words_of_why(fleet, live):
    """Per robot and type, with utility, the channel and what room costs."""
    head, _ = live.until(lambda head, _: (camera(head) or {}).get("why"))
    row = camera(head)
    assert row["type"] == "camera"
    assert row["made"] > row["sent"] > 0.0
    assert {each["words"] for each in row["why"]} <= {
        "a limit has no room for it",
        "others are worth more for what is left",
        "a newer one came before its turn",
    }
    assert row["worth"]["now"] <= row["worth"]["most"]
    (limit,) = head["limits"]
    assert limit["constraint"] == "throughput"
    assert limit["limit"] == pytest.approx(150e3 / 8 * 0.5, rel=0.05)
    assert head["point"]["limits"]["throughput"][1] == limit["limit"]
    assert head["by"] == "ground"
    _, _, body = fleet.page.ask("GET", "/why?robot=r1&key=robot/r1/camera")
    assert json.loads(body)["text"].startswith("robot/r1/camera of robot r1\n")


def test_who_is_not_asked_itself_does_not_tell_why(fleet):
    """The page says what to do about it; what is no key is refused, too."""
    status, _, body = fleet.page.ask("GET", "/why?robot=r7&key=robot/r1/camera")
    assert status == 409
    assert "only the daemon of r7 knows why" in json.loads(body)["problem"]
    assert fleet.page.ask("GET", "/why?robot=r1")[0] == 409


def test_red_is_marked_while_it_is_there(fleet, live):
    """And no longer than that."""
    marked = lambda head, _: any(each["marked"] for each in head.get("streams", ()))  # noqa: E731
    fleet.cameras[0].red = 1.0
    live.until(marked)
    fleet.cameras[0].red = 0.0
    live.until(lambda head, body: head["kind"] == "status" and head["streams"] and not marked(head, body))


def test_buttons_switch_all_robots(fleet, live):
    """Each says whether it did; variants of the specs come and go, and the way back is what was there."""
    assert fleet.page.told("/filter", {"filter": "off"}) == (
        200,
        {"outcomes": [{"robot": name, "obeyed": True, "said": ["mode pass"]} for name in ("ground", "r1")]},
    )
    live.until(lambda head, _: {robot["mode"] for robot in head.get("robots", ())} == {"pass"})
    for name, line in (("paper", 'aggregation = "most_recent"'), ("downsampling", 'scale = "1"')):
        status, answer = fleet.page.told("/filter", {"filter": name})
        assert status == 200
        assert all(each["obeyed"] for each in answer["outcomes"])
        live.until(lambda head, _, name=name: head.get("variant") == name)
        assert line in (fleet.folder / "r1" / "specs.d" / "camera.toml").read_text()
    assert fleet.page.told("/filter", {"filter": "on"})[0] == 200
    live.until(lambda head, _: head.get("variant") == "on")
    assert (fleet.folder / "r1" / "specs.d" / "camera.toml").read_text() == SPECS.format(limit="150 kbit/s")
    assert fleet.robots[0].status()["mode"] == "enforce"
    assert fleet.page.told("/filter", {"filter": "louder"})[0] == 409


def test_specs_go_live_when_they_are_right(fleet, live):
    """Mistakes come back with their line, and then no robot hears of it."""
    text = SPECS.format(limit="150 kbit/s")
    wrong = {"camera.toml": text.replace('"video"', '"vidoe"')}
    for path in ("/check", "/push"):
        status, answer = fleet.page.told(path, {"files": wrong})
        assert (status, answer["fit"]) == (200, False)
        (mistake,) = answer["errors"]
        assert (mistake["file"], mistake["line"]) == ("camera.toml", 10)
        assert 'did you mean "video"' in mistake["message"]
    before = fleet.robots[0].status()["specs"]
    new = {"camera.toml": text.replace("150 kbit/s", "170 kbit/s")}
    status, answer = fleet.page.told("/push", {"files": new})
    assert (status, answer["fit"]) == (200, True)
    assert [each["obeyed"] for each in answer["outcomes"]] == [True, True]
    head, _ = live.until(lambda head, _: head.get("specs") not in (before, None))
    _, _, body = fleet.page.ask("GET", "/specs")
    assert json.loads(body) == {"generation": head["specs"], "files": new, "variant": "on"}


@pytest.mark.parametrize(
    ("path", "body", "problem"),
    [
        ("/filter", b"[]", "what was sent is no object of JSON"),
        ("/filter", b"[" * 100_000, "what was sent is no object of JSON"),
        ("/check", b'{"files": {"a.toml": 3}}', "specs are sent as"),
        ("/check", b'{"files": {"../a.toml": ""}}', "is no name of a file of specs"),
        ("/check", rb'{"files": {"a.toml": "# \ud800"}}', "files of specs are UTF-8"),
        ("/push", rb'{"files": {"a.toml": "# \ud800"}}', "files of specs are UTF-8"),
        ("/push", b'{"files": {}}', "there is nothing to push"),
        ("/demo/channel", b'{"limit": 1e6, "latency": 0, "loss": 0}', "nobody answers at"),
        ("/demo/red", b'{"robot": 3}', "something red is ordered with"),
    ],
)
def test_what_cannot_be_is_said(fleet, path, body, problem):
    """In a sentence, with a status that is no success."""
    status, answer = fleet.page.told(path, body)
    assert status == 409
    assert problem in answer["problem"]


def test_too_much_is_not_even_read(fleet):
    """Nobody fills the memory."""
    status, answer = fleet.page.told("/check", b"x" * (TUNING.body_bytes + 1))
    assert (status, answer) == (413, {"problem": "that is too much"})


def test_who_leaves_in_the_middle_does_no_harm(fleet):
    """Nor who reads nothing; the next one is served."""
    host = "Host: localhost\r\n"
    for said in (
        f"POST /check HTTP/1.1\r\n{host}X-Sendworthy-Token: {fleet.page.token}\r\nContent-Length: 99\r\n\r\n{{",
        f"GET /live HTTP/1.1\r\n{host}\r\n",
    ):
        with socket.create_connection(("127.0.0.1", fleet.page.port)) as connection:
            connection.sendall(said.encode())
    assert fleet.page.ask("GET", "/")[0] == 200


@pytest.mark.parametrize("method", ["HEAD", "POST"])
def test_the_stream_is_there_for_get_only(fleet, method):
    """Anything else would take a viewer's place until its connection ends."""
    assert fleet.page.ask(method, "/live", {})[0] == 405


def test_only_so_many_pages_are_open_at_once(fleet):
    """Each takes what its network carries; those that go make room."""
    streams = []
    try:
        while len(streams) <= TUNING.viewers:
            streams.append(fleet.page.live())
            if streams[-1].status != 200:
                break
        assert streams[-1].status == 503
    finally:
        for stream in streams:
            stream.close()
    wait_until(lambda: opens(fleet.page), what="room for another page")


def opens(page):
    stream = page.live()
    stream.close()
    return stream.status == 200


def test_who_watches_hears_of_the_end(fleet):
    """The stream ends, and the process with it."""
    page = Served("--connect", fleet.ground.endpoint, "--key", "robot/*/camera", "--robot", "ground")
    stream = page.live()
    stream.until(lambda head, _: head["kind"] == "frame")
    assert page.end() == 130
    while stream.next() is not None:
        continue
    stream.close()
