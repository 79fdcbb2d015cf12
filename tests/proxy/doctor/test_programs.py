"""Asking programs."""

from proxy.doctor import programs
from proxy.doctor.programs import asked


def test_a_program_is_asked(program):
    """Its complaints are an answer too."""
    program("iw", 'echo "$1"; echo "$2" >&2; exit 3')
    assert asked("iw", "one", "two") == "one\ntwo\n"


def test_one_that_is_not_there_or_does_not_answer_says_nothing(program, monkeypatch):
    """Nobody waits for it."""
    assert asked("no-such-program") is None
    monkeypatch.setattr(programs, "_WAIT", 0.05)
    program("iw", "exec sleep 60")
    assert asked("iw") is None
