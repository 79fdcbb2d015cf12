"""What others wrote, on a terminal."""

from proxy.printable import clean


def test_what_a_terminal_would_obey_is_replaced():
    """Escape sequences are not names."""
    assert clean("ok") == "ok"
    assert clean("a\x1b[31m\tb") == "a\ufffd[31m\ufffdb"
