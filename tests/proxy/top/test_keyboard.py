"""Keys of a terminal."""

import os
import pty
import signal
import termios

import pytest

from proxy.top.keyboard import keyboard, keys_in


@pytest.fixture
def terminal():
    """Both ends of a terminal: what a person does, and what a program sees."""
    person, program = pty.openpty()
    yield person, program
    for descriptor in (person, program):
        try:
            os.close(descriptor)
        except OSError:
            continue


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("q", ["q"]),
        ("\x1b[A\x1b[B\x1bOA", ["up", "down", "up"]),
        ("\x1b[5~\x1b[6~\x1b[H\x1b[4~", ["pageup", "pagedown", "home", "end"]),
        ("\x1b", ["esc"]),
        ("\r\n\t\x7f\x03", ["enter", "enter", "tab", "backspace", "ctrl-c"]),
        ("é/ü", ["é", "/", "ü"]),
        ("\x1b[15~\x1b[1;5Cx\x01", ["x"]),
    ],
)
def test_what_is_read_becomes_keys(text, keys):
    """Sequences that mean nothing are left out whole."""
    assert keys_in(text) == keys


def test_each_key_comes_at_once_and_the_terminal_is_as_it_was_afterwards(terminal):
    """Also where something fails."""
    person, program = terminal
    before = termios.tcgetattr(program)

    def work(keys):
        assert not termios.tcgetattr(program)[3] & (termios.ICANON | termios.ECHO)
        os.write(person, b"s\x1b[B")
        assert keys.read() == ["s", "down"]
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), keyboard(program) as keys:
        work(keys)
    assert termios.tcgetattr(program) == before


def test_whoever_waits_for_keys_can_be_woken(terminal):
    """By any thread, however often; and by a terminal that changes its size."""
    _, program = terminal
    with keyboard(program) as keys:
        for _ in range(100_000):
            keys.wake()
        assert keys.read() == []
        os.kill(os.getpid(), signal.SIGWINCH)
        assert keys.read() == []


def test_the_end_of_the_process_ends_the_wait(terminal):
    """By leaving in order, so that the terminal is given back."""
    _, program = terminal
    before, handler = termios.tcgetattr(program), signal.getsignal(signal.SIGTERM)

    def work(keys):
        os.kill(os.getpid(), signal.SIGTERM)
        assert keys.read() is None

    with pytest.raises(SystemExit) as left, keyboard(program) as keys:
        work(keys)
    assert left.value.code == 128 + signal.SIGTERM
    assert termios.tcgetattr(program) == before
    assert signal.getsignal(signal.SIGTERM) is handler


def test_who_asks_for_the_end_once_more_does_not_wait_for_it(terminal):
    """A terminal that takes nothing holds up whoever writes to it."""
    _, program = terminal

    def work(keys):
        os.kill(os.getpid(), signal.SIGTERM)
        assert keys.ended == signal.SIGTERM
        os.kill(os.getpid(), signal.SIGTERM)
        pytest.fail("nothing ended it")

    with pytest.raises(SystemExit), keyboard(program) as keys:
        work(keys)


def test_a_terminal_that_is_gone_gives_no_keys(terminal):
    """The program ends."""
    person, program = terminal
    with keyboard(program) as keys:
        os.close(person)
        assert keys.read() is None
