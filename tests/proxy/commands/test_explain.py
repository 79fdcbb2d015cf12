"""`sendworthy explain`, by specs alone and with a daemon."""

import io
import json
import os
import re
import threading
from contextlib import closing, contextmanager
from pathlib import Path

import cv2
import numpy as np
import pytest
import zenoh

from proxy import exit_codes
from proxy.bridge.tuning import TUNING
from proxy.cli import main
from proxy.commands.client import NoAnswerError, connected
from proxy.commands.explain import ExplainError, _taken
from tests.ports import free_port
from tests.proxy.nodes import Heard, free_endpoint, plain_session
from tests.waiting import wait_until
from utility_specs import load_specs
from utility_specs.loader import load_set

SPECS = """\
[[constraint]]
kind = "throughput"
limit = "1 Mbit/s"

[[information_type]]
name = "battery"
keys = ["robot/*/battery"]
utility = { kind = "exponential", tau = "1 min" }
scale = "5 if charge < 0.2 else 0.5"
features.charge = { kind = "json", path = "charge", default = 1.0 }
forecast = { size = "60 B" }

[[information_type]]
name = "map"
keys = ["robot/*/map"]
utility = { kind = "step", lifetime = "10 s" }
scale = "known + mark"
features.known = { kind = "msgpack", path = "known" }
features.mark = { kind = "attachment", format = "uint8" }

[[information_type]]
name = "camera"
keys = ["robot/*/camera"]
utility = { kind = "video" }
scale = "change"
features.change = { kind = "change", default = 0.5 }
"""


@pytest.fixture
def specs(tmp_path):
    file = tmp_path / "specs.toml"
    file.write_text(SPECS)
    return str(file)


@pytest.fixture
def explained(capsys):
    """Run the command; give what it printed on both streams."""

    def run(*words, code=exit_codes.OK):
        assert main(["explain", *words]) == code
        return capsys.readouterr()

    return run


def test_a_sample_is_explained_by_specs_alone(explained, specs):
    """Its worth with the numbers in it, the plot, and what it competes with."""
    out = explained("robot/r1/battery", "--text", '{"charge": 0.1}', "--specs", specs).out
    assert out.startswith('robot/r1/battery (15 B): information type "battery"\n  covered by robot/*/battery (')
    assert "scale           = 5 if charge < 0.2 else 0.5 = 5 if 0.1 < 0.2 else 0.5 = 5\n" in out
    assert "⠉" in out
    assert "what it competes with, by what its bytes are worth in the first second" in out
    assert '--size "TYPE=50 kB"' in out


def test_payloads_come_from_files_standard_input_and_the_command_line(explained, specs, tmp_path, monkeypatch):
    """Whatever is at hand; MessagePack is written as JSON."""
    file = tmp_path / "payload.json"
    file.write_text('{"charge": 0.125}')
    assert "charge  = 0.125\n" in explained("robot/r1/battery", str(file), "--specs", specs).out
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b'{"charge": 0.25}')))
    assert "charge  = 0.25\n" in explained("robot/r1/battery", "-", "--specs", specs).out
    mark = tmp_path / "attachment"
    mark.write_bytes(b"\x07")
    out = explained("robot/r1/map", "--msgpack", '{"known": 0.5}', "--attachment", str(mark), "--specs", specs).out
    assert "scale          = known + mark = 0.5 + 7 = 7.5\n" in out
    assert out.startswith("robot/r1/map (17 B")  # payload and attachment


def test_whatever_is_typed_is_no_traceback(explained, specs):
    """A shell passes on any bytes, and people paste."""
    key = explained("robot/\udcff/battery", "--specs", specs, code=exit_codes.FAILED).err
    assert key == 'sendworthy explain: "robot/\ufffd/battery" is not a key: it is not UTF-8\n'
    text = explained("robot/r1/battery", "--text", "\udcff", "--specs", specs).out
    assert text.startswith("robot/r1/battery (1 B): ")
    deep = explained("robot/r1/map", "--msgpack", "[" * 100_000, "--specs", specs, code=exit_codes.FAILED).err
    assert "is not JSON: maximum recursion depth exceeded" in deep


@pytest.mark.parametrize("words", [["{}"], ["--text", "{}", "--attachment", "{}"], ["-"]])
def test_no_more_is_read_than_a_sample_may_be(explained, specs, tmp_path, monkeypatch, words):
    """A device such as /dev/zero has no end."""
    file = tmp_path / "large"
    file.touch()
    command = ["robot/r1/other", *(word.format(file) for word in words), "--specs", specs]
    with file.open() as given:
        monkeypatch.setattr("sys.stdin", given)
        os.truncate(file, 8_000_000)
        assert explained(*command).out.startswith("robot/r1/other (")
        given.seek(0)
        os.truncate(file, TUNING.largest_message + 1)
        shown = explained(*command, code=exit_codes.FAILED).err
    assert shown.endswith(": is larger than 64 MiB, as no sample is that crosses the mesh\n")


def test_without_a_payload_the_defaults_hold_and_specs_say_the_size(explained, specs):
    """Enough to see what a type is worth."""
    out = explained("robot/r1/battery", "--specs", specs).out
    assert out.startswith("robot/r1/battery (60 B): ")
    assert "charge  = 1, its default: the sample has no payload\n" in out
    assert explained("robot/r1/other", "--specs", specs).out.startswith("robot/r1/other (0 B): no information type")


def test_sizes_and_receivers_can_be_given(explained, specs):
    """Of the sample, and of the types it competes with."""
    out = explained(
        *("robot/r1/battery", "--specs", specs, "--receivers", "3"),
        *("--size", "2 kB", "--size", "map=1 kB", "--size", "camera=40 kB"),
    ).out
    assert out.startswith("robot/r1/battery (2 kB, for 3 robots)")
    assert "   map" in out
    assert "size not known" not in out
    assert "TYPE=50 kB" not in out


def test_scripts_get_json(explained, specs):
    """All of it, and nothing else."""
    out = explained("robot/r1/battery", "--text", '{"charge": 0.1}', "--specs", specs, "--json", "--ascii").out
    data = json.loads(out)
    assert data["worth"]["scale"]["value"] == 5.0
    assert [each["name"] for each in data["competitors"] if each["this"]] == ["battery"]
    assert "same_specs" not in data


def test_plain_characters_do_where_there_are_no_others(specs, monkeypatch):
    """Where somebody asks for them, or the output's encoding has no more."""
    out = io.BytesIO()
    with io.TextIOWrapper(out, encoding="ascii", write_through=True) as ascii_only, monkeypatch.context() as patch:
        patch.setattr("sys.stdout", ascii_only)
        assert main(["explain", "robot/é/battery", "--specs", specs]) == exit_codes.OK
        text = out.getvalue().decode("ascii")
    assert text.startswith("robot/?/battery (60 B)")
    assert "= weight x scale x utility = 1 x 0.5 x 1" in text
    assert "0.5 |*" in text


def test_ascii_can_be_asked_for(explained, specs):
    """In a terminal without a font for Braille."""
    assert explained("robot/r1/battery", "--specs", specs, "--ascii").out.isascii()


def test_a_type_that_is_alone_competes_with_none(explained, tmp_path):
    """Only with samples of its own."""
    file = tmp_path / "one.toml"
    file.write_text('[[information_type]]\nname = "a"\nkeys = ["a"]\nutility = { kind = "step", lifetime = 1 }\n')
    assert explained("a", "--specs", str(file)).out.endswith("competes with it, only samples of its own\n")


MISTAKES = {
    "robot//battery": '"robot//battery" is not a key',
    "/robot/r1/battery": '"/robot/r1/battery" is not a key: chunks with / between them, none of them empty; write "',
    "robot/*/battery": '"robot/*/battery" stands for many keys; a sample has one of them',
    "robot/r1/battery --size batery=1kB": '--size: there is no information type "batery" (did you mean "battery"?)',
    "robot/r1/battery nosuch": "nosuch: cannot be read: No such file or directory",
    "robot/r1/battery --attachment .": ".: cannot be read: Is a directory",
    "robot/r1/map --msgpack {": '--msgpack: "{" is not JSON: ',
}


@pytest.mark.parametrize("words", MISTAKES)
def test_mistakes_are_named(explained, specs, words):
    """What was asked for, and what is wrong with it."""
    shown = explained(*words.split(), "--specs", specs, code=exit_codes.FAILED)
    assert shown.err.startswith(f"sendworthy explain: {MISTAKES[words]}")
    assert shown.out == ""


@pytest.mark.parametrize("flag", ["--size 5", "--receivers 0", "--receivers x", "--timeout soon", "--live --text a"])
def test_flags_that_make_no_sense_are_refused(flag, specs, capsys):
    """As by every command."""
    with pytest.raises(SystemExit) as refused:
        main(["explain", "a", "--specs", specs, *flag.split()])
    assert refused.value.code == exit_codes.USAGE
    assert flag.split()[0] in capsys.readouterr().err


@pytest.mark.parametrize("flag", ["--size=5 B", "--attachment=x"])
def test_a_live_sample_brings_all_with_it(explained, specs, flag):
    """What would be ignored is refused."""
    shown = explained("a", "--live", flag, "--specs", specs, code=exit_codes.USAGE)
    assert shown.err == "sendworthy explain: with --live the sample has its own size and attachment\n"


def test_wrong_specs_are_named_with_file_line_and_key(explained, tmp_path):
    """As `sendworthy check` does."""
    file = tmp_path / "wrong.toml"
    file.write_text(SPECS.replace("charge < 0.2", "chrge < 0.2"))
    shown = explained("robot/r1/battery", "--specs", str(file), code=exit_codes.FAILED)
    assert shown.err.startswith(f'{file}:9: information_type "battery": scale: unknown feature "chrge"')


@contextmanager
def publishing(where, key, payloads):
    """Publish these payloads by turns on a key of the daemon's application side."""
    over, session = threading.Event(), plain_session("client", connect=[where])

    def publish():
        number = 0
        while not over.wait(0.01):
            session.put(key, payloads[number % len(payloads)])
            number += 1
            session.delete(key)

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        session.close()


@pytest.fixture(scope="module")
def router():
    """A Zenoh router that answers as the daemon whose status it is given."""
    endpoint, status, asked = free_endpoint(), {}, []

    def answer(query):
        asked.append(query.key_expr)
        last = {"key": "robot/r1/battery", "reason": "forwarded", "send": True, "age": 0.1}
        told = status | ({"decisions": {"last": last}} if len(asked) > 3 else {})
        query.reply("@sendworthy/r1/status", json.dumps(told))
        query.drop()

    with plain_session("router", listen=[endpoint]) as session:
        session.declare_queryable("@sendworthy/*/status", zenoh.handlers.Callback(answer, indirect=False))
        yield endpoint, status, asked


@pytest.fixture
def robot(router, specs):
    """The status of a daemon with these specs, which decides on the battery when it was asked three times."""
    endpoint, status, asked = router
    asked.clear()
    status.clear()
    status |= {
        "endpoint": endpoint,
        "robot": "r1",
        "mode": "enforce",
        "specs": load_specs(Path(specs)).generation,
        "daemon": {"specs": specs},
        "streams": [
            {"robot": "r1", "key": "robot/r1/battery", "type": "battery", "scale": 5.0, "size": 15, "receivers": 2}
        ],
        "decisions": {"last": None},
    }
    return status


def test_the_next_sample_is_taken_from_the_daemon(explained, robot):
    """With what the daemon knows of its stream, once it has decided; deletes are no samples."""
    with publishing(robot["endpoint"], "robot/r1/battery", [b'{"charge": 0.1}']):
        out = explained("--live", "robot/*/battery", "--connect", robot["endpoint"]).out
    assert out.startswith("robot/r1/battery (15 B, for 2 robots)")
    assert "charge  = 0.1\n" in out
    assert re.search("last one +forwarded, 100 ms ago\n", out)
    assert "robot/r1/battery of r1" in out


def test_a_key_cannot_command_the_terminal(explained, robot):
    """Keys are words of whoever publishes: of the sample, and of streams beside it."""
    key = "robot/\x1b[2J\x07/battery"
    robot["streams"].append(robot["streams"][0] | {"key": "robot/\x1b[31m/battery"})
    with publishing(robot["endpoint"], key, [b'{"charge": 0.1}']):
        out = explained("--live", "robot/*/battery", "--connect", robot["endpoint"]).out
    assert out.startswith("robot/\ufffd[2J\ufffd/battery (15 B")
    assert "robot/\ufffd[31m/battery of r1" in out
    assert all(line.isprintable() for line in out.splitlines())


def test_scripts_get_live_explanations_too(explained, robot):
    """And whether the specs that explain are those in force."""
    with publishing(robot["endpoint"], "robot/r1/battery", [b'{"charge": 0.1}']):
        data = json.loads(explained("--live", "robot/r1/battery", "--json", "--connect", robot["endpoint"]).out)
        robot["specs"] = "another"
        other = json.loads(explained("--live", "robot/r1/battery", "--json", "--connect", robot["endpoint"]).out)
        text = explained("--live", "robot/r1/battery", "--connect", robot["endpoint"]).out
    assert (data["same_specs"], other["same_specs"]) == (True, False)
    assert data["daemon"]["last_decision"]["reason"] == "forwarded"
    assert data["worth"]["factor"] == 5.0
    assert "robot r1 has other specs in force (another) than those read here" in text


def test_an_image_is_compared_with_the_one_before(explained, robot):
    """Two are taken; of keys that no stream has nothing is known."""
    images = [cv2.imencode(".png", np.full((64, 64, 3), level, np.uint8))[1].tobytes() for level in (0, 255)]
    with publishing(robot["endpoint"], "robot/r1/camera", images):
        out = explained("--live", "robot/r1/camera", "--connect", robot["endpoint"]).out
    assert "change  = 1\n" in out
    assert "nothing of this key" in out


def test_a_second_image_that_does_not_come_is_told(robot, specs):
    """Nothing can be said of how it changed."""
    where, key = robot["endpoint"], "robot/r1/camera"
    with publishing(where, key, [b"x"]), connected(where) as daemon, closing(daemon.samples(key, 60.0)) as samples:
        sample = next(samples)

    def alone():
        yield sample
        raise NoAnswerError

    with pytest.raises(ExplainError, match="compares two samples, and only one came in time"):
        _taken(alone(), load_set([Path(specs)]))


def test_uncovered_live_samples_compete_with_nothing(explained, robot):
    """They pass, and what is decided on beside them is told."""
    robot["streams"].append({"robot": "r1", "key": "x", "type": "battery"})
    with publishing(robot["endpoint"], "other", [b"x"]):
        out = explained("--live", "other", "--connect", robot["endpoint"]).out
        robot["streams"] = []
        none = explained("--live", "other", "--connect", robot["endpoint"]).out
    assert "what is decided on beside it" in out
    assert "beside it" not in none


def test_no_sample_within_the_time_is_an_error(explained, robot):
    """Instead of a command that hangs."""
    words = ("--live", "robot/r1/battery", "--timeout", "10 ms", "--connect", robot["endpoint"])
    shown = explained(*words, code=exit_codes.FAILED)
    assert f"no sample of robot/r1/battery came within 0.01 s at {robot['endpoint']}" in shown.err


def test_the_specs_of_the_daemon_are_the_default(explained, robot):
    """Also for what is not live; those on another machine have to be copied."""
    where = ("--connect", robot["endpoint"])
    assert "same_specs" in explained("robot/r1/battery", "--json", *where).out
    robot["daemon"] = {"specs": "/nowhere/specs.d"}
    shown = explained("robot/r1/battery", *where, code=exit_codes.FAILED)
    assert "the specs of robot r1 are in /nowhere/specs.d, which is not on this machine" in shown.err
    robot["daemon"] = {}
    assert "the specs of robot r1 are not known" in explained("a", *where, code=exit_codes.FAILED).err
    robot["specs"] = "0" * 12
    assert "robot r1 has no specs, so all samples pass at once" in explained("a", *where, code=exit_codes.FAILED).err


def test_specs_that_the_daemon_has_not_taken_up_yet_are_explained(explained, robot, specs):
    """As they were just written, with a remark; an empty folder holds none."""
    where = ("--connect", robot["endpoint"])
    robot["specs"] = "0" * 12
    assert "robot r1 has other specs in force (000000000000)" in explained("robot/r1/battery", *where).out
    robot["daemon"] = {"specs": str(Path(specs).parent / "specs.d")}
    (Path(specs).parent / "specs.d").mkdir()
    assert "robot r1 has no specs" in explained("a", *where, code=exit_codes.FAILED).err
    robot["daemon"] = {"specs": "/" + 5_000 * "a"}
    assert "File name too long: '/aa" in explained("a", *where, code=exit_codes.FAILED).err


def test_without_a_daemon_the_message_says_so(explained):
    """Where nobody can be asked for specs."""
    where = f"tcp/127.0.0.1:{free_port()}"
    shown = explained("robot/r1/battery", "--connect", where, code=exit_codes.FAILED)
    assert shown.err == f"sendworthy explain: no daemon answers at {where}; is `sendworthy run` running?\n"


def test_a_real_daemon_tells_of_its_live_samples(explained, start, tmp_path):
    """What it knows of the stream, what it decided on it so far, and why the last decision was what it was."""
    file, mesh = tmp_path / "live.toml", free_endpoint()
    file.write_text(
        SPECS.replace('kind = "throughput"\nlimit = "1 Mbit/s"', 'kind = "messages"\nlimit = 12\nwindow = 1')
    )
    daemon = start("--robot", "r1", "--specs.path", str(file), "--mesh.listen", f'["{mesh}"]')
    daemon.wait_for("sendworthy ")
    key, live = "robot/r1/battery", ("--live", "robot/*/battery", "--connect", daemon.endpoint)
    with (
        plain_session("peer", connect=[mesh]) as other,
        publishing(daemon.endpoint, key, [b'{"charge": 0.1}']),
    ):
        heard = Heard(other, "robot/*/battery")

        def fates():
            return next((each["by_reason"] for each in daemon.status()["streams"] if each["key"] == key), {})

        wait_until(lambda: "forwarded" in fates() and len(fates()) > 1, what="samples that were sent and dropped")
        out = explained(*live).out
        data = json.loads(explained(*live, "--json").out)
    assert heard.payloads.count('{"charge": 0.1}') > 0
    assert out.startswith('robot/r1/battery (15 B): information type "battery"')
    assert "what robot r1 knows (mode enforce)\n" in out
    assert re.search("decided on +[0-9]+ dropped:", out)
    assert re.search("last one +(forwarded|dropped)", out)
    assert re.search("wanted by +1 robot\n", out)
    (stream,) = data["daemon"]["streams"]
    assert (data["same_specs"], data["worth"]["factor"], stream["receivers"]) == (True, 5.0, 1)
    assert sum(stream["by_reason"].values()) <= stream["generated"]
