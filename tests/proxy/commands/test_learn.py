"""`sendworthy learn`, live at a daemon or a router, and from recordings."""

import errno
import os
import re
import signal
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest
import zenoh

from proxy import exit_codes
from proxy.cli import main
from proxy.commands import learn as learning
from proxy.commands import listening
from tests.daemons import specs_file
from tests.proxy.nodes import free_endpoint, plain_session
from tests.utility_specs.learning.team import team
from tests.waiting import wait_until
from utility_specs import load_specs
from utility_specs.learning.recording import Reader, Writer

ROOT = Path(__file__).parent.parent.parent.parent
SAMPLES = [sample for sample in team("alice", "bob") if sample.time < 6.0]
KEYS = {sample.key for sample in SAMPLES}
BLOCK = zenoh.CongestionControl.BLOCK
TYPES = {
    "camera": ("robot/*/camera",),
    "pose": ("robot/*/pose",),
    "battery": ("robot/*/battery",),
    "map": ("robot/*/map",),
    "alarm": ("robot/*/alarm",),
}


@contextmanager
def publishing(endpoint):
    """A team's samples at a daemon, over and over, as fast as they are wanted."""
    over = threading.Event()

    def publish():
        with plain_session("client", connect=(endpoint,)) as session:
            publishers = {key: session.declare_publisher(key, congestion_control=BLOCK) for key in KEYS}
            while not over.wait(0.01):
                if all(publisher.matching_status.matching for publisher in publishers.values()):
                    for sample in SAMPLES:
                        publishers[sample.key].put(sample.payload, encoding=sample.encoding)

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


@pytest.fixture
def recording(tmp_path):
    """A recording of a team."""
    path = tmp_path / "traffic.rec"
    with path.open("wb") as file:
        writer = Writer(file, ["alice", "bob"])
        for sample in SAMPLES:
            writer.add(sample)
    return path


def covers_all(path):
    """Whether a spec has a type for every key. Which are alike depends on timing, and that on what else runs here."""
    specs = load_specs(path)
    return all(specs.match(sample.key) for sample in SAMPLES)


def types_in(path):
    return {each.name: each.keys for each in load_specs(path).types}


def test_a_spec_is_learned_at_a_daemon(daemon, tmp_path, capsys):
    """Every kind of stream that is heard is a type; what was heard can be kept, and says the same again."""
    spec, kept, again = tmp_path / "specs.d" / "learned.toml", tmp_path / "kept.rec", tmp_path / "again.toml"
    said = ["--connect", daemon.endpoint, "--samples", str(2 * len(SAMPLES)), "--seconds", "60"]
    with publishing(daemon.endpoint):
        assert main(["learn", *said, "-o", str(spec), "--record", str(kept)]) == exit_codes.OK
    out, err = capsys.readouterr()
    assert out == f"{spec}: written; now set the weights and the limit in it\n"
    assert err == f"listening at {daemon.endpoint} for 60 s\nheard {2 * len(SAMPLES)} samples\n"
    assert covers_all(spec)
    assert "# In mode enforce, with specs: r1." in spec.read_text()
    assert re.search(r"# In force at r1 now: throughput: \d+ B in any 0.5 s.", spec.read_text())
    assert main(["check", str(spec)]) == exit_codes.OK
    assert main(["learn", str(kept), "-o", str(again)]) == exit_codes.OK
    with kept.open("rb") as file:
        heard = list(Reader(file))
    assert {(each.key, each.payload, each.encoding) for each in heard} <= {
        (each.key, each.payload, each.encoding or "zenoh/bytes") for each in SAMPLES
    }
    assert covers_all(again)


def test_some_keys_of_a_router_are_learned_until_ctrl_c(stack, tmp_path, capsys):
    """Without any daemon; what was heard until then counts."""
    endpoint, kept = free_endpoint(), tmp_path / "kept.rec"
    router = stack.enter_context(plain_session("router", listen=(endpoint,)))
    publishers = [router.declare_publisher(f"robot/alice/{name}") for name in ("pose", "battery")]

    def interrupt():
        wait_until(lambda: publishers[1].matching_status.matching, what="the subscriber")
        for publisher in publishers:
            publisher.put(b'{"charge": 0.5}')
        wait_until(lambda: b"charge" in kept.read_bytes(), what="the sample in the recording")
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    words = ["learn", "--connect", endpoint, "--keys", "robot/*/battery", "--record", str(kept), "--seconds", "60"]
    assert main(words) == exit_codes.OK
    thread.join()
    keys = re.findall(r"^keys = .*$", capsys.readouterr().out, re.MULTILINE)
    assert keys == ['keys = ["robot/alice/battery"]']


def test_listening_ends_when_memory_is_full(daemon, capsys, monkeypatch):
    """The spec says so, and so does the command."""
    monkeypatch.setattr(listening, "MOST_BYTES", 30_000)
    with publishing(daemon.endpoint):
        assert main(["learn", "--connect", daemon.endpoint, "--seconds", "60"]) == exit_codes.OK
    out, err = capsys.readouterr()
    assert "# Listening ended early, with 256 MiB; --record takes more, --keys only a part." in out
    assert "sendworthy learn: Listening ended early" in err


def test_a_recording_that_is_cut_off_is_used(recording, capsys):
    """As far as it is whole; what is lacking is said."""
    recording.write_bytes(recording.read_bytes()[:-5])
    assert main(["learn", str(recording)]) == exit_codes.OK
    out, err = capsys.readouterr()
    cut = f"the recording is cut off: {len(SAMPLES) - 1} samples before that"
    assert err == f"sendworthy learn: {recording}: {cut}\n"
    assert f"# T{cut[1:]}." in out


def test_what_is_no_recording_is_refused(tmp_path, capsys):
    """By name."""
    path = tmp_path / "x.rec"
    assert main(["learn", str(path)]) == exit_codes.FAILED
    assert main(["learn", "no.toml"]) == exit_codes.FAILED
    path.write_text("robot")
    assert main(["learn", str(path)]) == exit_codes.FAILED
    with path.open("wb") as file:
        Writer(file)
    assert main(["learn", str(path)]) == exit_codes.FAILED
    assert capsys.readouterr().err.splitlines() == [
        f"sendworthy learn: {path} cannot be read: No such file or directory",
        "sendworthy learn: no.toml cannot be read: No such file or directory; to write a spec to it, say -o no.toml",
        f"sendworthy learn: {path} is not a recording of `sendworthy learn --record`",
        "sendworthy learn: there are no samples to learn from",
    ]


def test_files_are_not_replaced_unless_forced(recording, tmp_path, capsys):
    """Neither a spec nor a recording; nothing is listened to then."""
    spec = tmp_path / "learned.toml"
    spec.write_text("mine")
    for words in (["learn", str(recording), "-o", str(spec)], ["learn", "--record", str(recording)]):
        assert main(words) == exit_codes.FAILED
    assert capsys.readouterr().err.splitlines() == [
        f"sendworthy learn: {spec} exists; --force replaces it",
        f"sendworthy learn: {recording} exists; --force replaces it",
    ]
    assert spec.read_text() == "mine"
    assert main(["learn", str(recording), "-o", str(spec), "--force"]) == exit_codes.OK
    assert types_in(spec) == TYPES
    assert [path.name for path in tmp_path.iterdir() if path != recording] == ["learned.toml"]


def test_a_link_stays_one(recording, tmp_path):
    """What it leads to is replaced."""
    kept, link = tmp_path / "repository" / "l.toml", tmp_path / "specs.d" / "l.toml"
    for path in (kept, link):
        path.parent.mkdir()
    kept.write_text("mine")
    link.symlink_to(kept)
    assert main(["learn", str(recording), "-o", str(link), "--force"]) == exit_codes.OK
    assert link.is_symlink()
    assert types_in(kept) == TYPES
    assert [path.name for path in (*kept.parent.iterdir(), *link.parent.iterdir())] == ["l.toml", "l.toml"]


def test_a_pipe_is_written_into(recording, tmp_path, capsys):
    """It stays one, and nothing else is said to whom it may lead."""
    pipe, copy = tmp_path / "pipe", tmp_path / "copy.toml"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    assert main(["learn", str(recording), "-o", str(pipe), "--force"]) == exit_codes.OK
    copy.write_bytes(os.read(reader, 65536))
    os.close(reader)
    assert types_in(copy) == TYPES
    assert pipe.is_fifo()
    assert capsys.readouterr() == ("", "")


def full(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def test_a_disk_that_gets_full_leaves_nothing_behind(recording, tmp_path, monkeypatch, capsys):
    """What was there stays."""
    spec = tmp_path / "learned.toml"
    spec.write_text("mine")
    monkeypatch.setattr(Path, "replace", full)
    assert main(["learn", str(recording), "-o", str(spec), "--force"]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy learn: cannot write {spec}: No space left on device\n"
    assert spec.read_text() == "mine"
    assert {path.name for path in tmp_path.iterdir()} == {"learned.toml", recording.name}


@pytest.mark.parametrize("method", ["__init__", "add"])
def test_a_recording_that_fills_the_disk_ends_and_says_so(daemon, tmp_path, monkeypatch, capsys, method):
    """At once, with the header and with any sample."""
    path = tmp_path / "traffic.rec"
    monkeypatch.setattr(learning.Writer, method, full)
    words = ["learn", "--record", str(path), "--seconds", "300", "--connect", daemon.endpoint]
    with publishing(daemon.endpoint):
        assert main(words) == exit_codes.FAILED
    assert capsys.readouterr().err.splitlines()[-1] == f"sendworthy learn: cannot write {path}: No space left on device"


def test_neighbours_that_do_not_go_with_it_are_told(recording, tmp_path, capsys):
    """The daemon would refuse the folder."""
    folder = tmp_path / "specs.d"
    folder.mkdir()
    specs_file(folder)
    assert main(["learn", str(recording), "-o", str(folder / "learned.toml")]) == exit_codes.OK
    err = capsys.readouterr().err
    assert err.startswith(f"sendworthy learn: with the other files of {folder}, it is not right:\n")
    assert 'information_type "camera"' in err


def test_where_nothing_can_be_written_the_command_says_so(daemon, recording, tmp_path, capsys):
    """Neither specs nor recordings."""
    nowhere = tmp_path / "file" / "where"
    (tmp_path / "file").touch()
    assert main(["learn", str(recording), "-o", str(nowhere / "x.toml")]) == exit_codes.FAILED
    assert main(["learn", "--record", str(nowhere / "x.rec"), "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert capsys.readouterr().err.splitlines() == [
        f"sendworthy learn: cannot write {nowhere / 'x.toml'}: Not a directory",
        f"sendworthy learn: cannot write {nowhere / 'x.rec'}: Not a directory",
    ]


def test_a_folder_that_cannot_be_written_to_is_told_before_anybody_listens(tmp_path, capsys, monkeypatch):
    """Not after half a minute, in place of the spec."""
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert main(["learn", "-o", str(tmp_path / "x.toml"), "--connect", "tcp/127.0.0.1:1"]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy learn: cannot write {tmp_path / 'x.toml'}: Permission denied\n"


def test_a_place_that_cannot_be_looked_at_is_named(recording, tmp_path, capsys):
    """As it may not be, or has no name that a file could have."""
    path = tmp_path / ("x" * 300 + ".toml")
    assert main(["learn", str(recording), "-o", str(path)]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy learn: cannot write {path}: File name too long\n"


def test_where_nothing_is_published_nothing_is_written(daemon, tmp_path, capsys):
    """It says where it listened: most likely the applications are somewhere else."""
    file = tmp_path / "learned.toml"
    assert main(["learn", "-o", str(file), "--seconds", "0.2", "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert f"nothing was published at {daemon.endpoint}; " in capsys.readouterr().err
    assert not file.exists()


def test_a_daemon_of_another_version_is_told(stand_in, capsys):
    """What it does not say of its team cannot be noted."""
    said = '{"robot": "r1", "peers": [{}]}'
    where = stand_in({"@sendworthy/r1/status": lambda query: query.reply("@sendworthy/r1/status", said)})
    assert main(["learn", "--seconds", "0.1", "--connect", where]) == exit_codes.FAILED
    assert capsys.readouterr().err == f"sendworthy learn: what answers at {where} is no daemon of this version\n"


def test_a_daemon_that_is_asked_for_by_name_must_answer(daemon, capsys):
    """Another one is not listened to."""
    assert main(["learn", "--robot", "r9", "--connect", daemon.endpoint]) == exit_codes.FAILED
    assert capsys.readouterr().err == f'sendworthy learn: no daemon of robot "r9" answers at {daemon.endpoint}\n'


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["x.rec", "--record", "y.rec"], "sendworthy learn: give it a RECORDING or --record, not both"),
        (["--seconds", "0"], 'must be a number above 0, not "0"'),
        (["--seconds", "nan"], 'must be a number above 0, not "nan"'),
        (["--samples", "some"], 'must be a number above 0, not "some"'),
        (["--keys", "a//b"], "--keys: "),
    ],
)
def test_a_wrong_command_line_is_refused(capsys, words, message):
    """Exit code 2, and why."""
    try:
        code = main(["learn", *words])
    except SystemExit as left:
        code = left.code
    assert code == exit_codes.USAGE
    assert message in capsys.readouterr().err


def test_a_key_that_is_not_utf_8_is_refused(capsys):
    """A shell passes on any bytes."""
    with pytest.raises(SystemExit):
        main(["learn", "--keys", "rob\udcff"])
    assert 'must be a key expression, not "rob\ufffd": it is not UTF-8' in capsys.readouterr().err


def test_a_spec_that_does_not_load_is_not_written():
    """Should Sendworthy be wrong in what it learns, it says so."""
    with pytest.raises(learning.OutputError, match=r"a mistake of Sendworthy:\n.*learned\.toml:1: version: must be 1"):
        learning._check("version = 2\n")
