"""`sendworthy replay` on recordings."""

import sys
from dataclasses import replace

import pytest

from proxy import exit_codes
from proxy.cli import main
from proxy.core.core import Core
from proxy.core.interface import events as ev
from proxy.recording.output import text_of
from proxy.recording.writing import RecordingWriter
from tests.proxy.recording.lives import START, published, recorded
from utility_specs import Specs

BEGIN = replace(START, generation=Specs.empty().generation)


@pytest.fixture
def life(tmp_path):
    """Write what a core without specs does with a few events, of which `change` may change the commands."""

    def write(change=lambda commands: commands):
        core = Core(BEGIN.settings, Specs.empty(), BEGIN.now)
        path = tmp_path / "r1.mcap"
        with RecordingWriter(path, BEGIN) as writer:
            writer.specs(text_of(Specs.empty()))
            for event in (ev.TimePassed(1.5), published(60), ev.TimePassed(3.0)):
                writer.happened(event, change(core.handle(event)))
        return path

    return write


def test_all_equal(life, capsys):
    """It says of how much."""
    assert main(["replay", str(life())]) == exit_codes.OK
    shown = capsys.readouterr().out
    assert shown.startswith("r1, 2.0 s: 0 decisions and ")
    assert shown.endswith(" commands in 3 events, all equal\n")


def test_the_first_difference_is_shown(life, capsys):
    """With the event after which it is."""
    assert main(["replay", str(life(lambda _: []))]) == exit_codes.FAILED
    shown = capsys.readouterr().out
    assert "not all equal" in shown
    assert "event 0 (TimePassed at 1.500000 s) has other commands: 0 were asked for, and " in shown


def test_a_recording_is_replayed_as_far_as_it_goes(life, tmp_path, capsys):
    """And what is wrong with it is said."""
    data = life().read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[:-20])
    assert main(["replay", str(tmp_path / "cut.mcap")]) == exit_codes.OK
    shown = capsys.readouterr()
    assert "3 events, all equal" in shown.out
    assert not shown.err  # only the summary lacks
    (tmp_path / "cut.mcap").write_bytes(data[: data.index(b"zstd") + 400])
    assert main(["replay", str(tmp_path / "cut.mcap")]) == exit_codes.FAILED
    assert "cut off" in capsys.readouterr().err


def test_what_cannot_be_replayed_is_told(tmp_path, capsys):
    """File by file; the others are replayed."""
    (tmp_path / "no.mcap").write_bytes(b"")
    other = recorded(tmp_path / "a.mcap", 3)
    assert main(["replay", str(tmp_path / "no.mcap"), str(other)]) == exit_codes.FAILED
    shown = capsys.readouterr().err
    assert "no.mcap is empty" in shown
    assert "the specs  are not in the recording" in shown


def test_the_words_of_a_recording_cannot_command_the_terminal(tmp_path, capsys):
    """It may come from anybody; what is wrong with it is told in its words, too."""
    recorded(tmp_path / "a.mcap", 3, replace(BEGIN, robot="r\x1b[2J", generation="\x1b[2J"))
    with RecordingWriter(tmp_path / "b.mcap", replace(BEGIN, robot="r\x1b[2J", zid="z2")) as writer:
        writer.specs(text_of(Specs.empty()))
        writer.happened(ev.TimePassed(1.5), [])
    assert main(["replay", *map(str, tmp_path.iterdir())]) == exit_codes.FAILED
    shown = capsys.readouterr()
    assert "r\ufffd[2J, 0.5 s" in shown.out
    assert "the specs \ufffd[2J are not in the recording" in shown.err
    assert "\x1b" not in shown.out + shown.err


def test_without_the_extra_it_says_which_to_install(monkeypatch, capsys):
    """It is loaded when it is needed."""
    monkeypatch.setitem(sys.modules, "studies.replay.replaying", None)
    assert main(["replay", "a.mcap"]) == exit_codes.FAILED
    assert 'pip install "sendworthy[record]"' in capsys.readouterr().err
