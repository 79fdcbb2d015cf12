"""Answers to all decisions that come up."""

from proxy.core.interface.commands import Decide, Drop, Forward
from tests.proxy.core.talk import only


def decide_all(talk, now, commands, *, send):
    """Answer every decision that comes up; return what was forwarded and dropped."""
    outcomes = only(commands, Forward, Drop)
    while decisions := only(commands, Decide):
        commands = talk.answer(now, decisions[0], send=send)
        outcomes += only(commands, Forward, Drop)
    return outcomes
