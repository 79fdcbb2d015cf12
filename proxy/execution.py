"""Carries out what the core asks for."""

import logging
from dataclasses import dataclass

from proxy import clock
from proxy.bridge.bridge import Bridge
from proxy.bridge.presence import Presence
from proxy.core.interface.commands import (
    AskState,
    Command,
    Decide,
    Drop,
    Forget,
    Forward,
    Keep,
    NoteInterest,
    Notice,
    Reread,
    Retain,
    SendCopy,
    SendDigest,
    SendState,
    SetPace,
    TellBacklog,
)
from proxy.core.interface.events import SampleRefused, SampleReread
from proxy.features import Extractor
from proxy.loop import Loop
from proxy.planning import Planning

log = logging.getLogger(__name__)

_LEVELS = {"info": logging.INFO, "warning": logging.WARNING, "error": logging.ERROR}

_OfSamples = Forward | Drop | Keep | Forget | SendCopy | Retain | SetPace | NoteInterest
_ToOthers = SendDigest | SendState | AskState | TellBacklog


@dataclass(frozen=True, slots=True)
class Execution:
    """Hands each command to the part that does it. By who uses the core; never blocks."""

    bridge: Bridge
    presence: Presence
    planning: Planning
    extractor: Extractor
    loop: Loop

    def __call__(self, command: Command) -> None:
        """Carry out one command."""
        if type(command) is Forward:  # as nearly all are
            self.bridge.forward(command.sample)
            return
        match command:
            case Decide():
                self.planning.decide(command)
            case Reread(sample, key):
                self._reread(sample, key)
            case Notice(level, text, fields):
                log.log(_LEVELS[level], "%s", text, extra=dict(fields))
            case SendDigest() | SendState() | AskState() | TellBacklog():
                self._tell(command)
            case _:
                self._carry(command)

    def _carry(self, command: _OfSamples) -> None:
        bridge = self.bridge
        match command:
            case Forward(sample):
                bridge.forward(sample)
            case Drop(sample):
                bridge.payloads.drop(sample)
            case Keep(sample):
                bridge.payloads.keep(sample)
            case Forget(sample):
                bridge.payloads.forget(sample)
            case SendCopy(sample, to):
                bridge.send_copy(sample, to)
            case Retain(expressions):
                bridge.retain(expressions)
            case SetPace(rate):
                bridge.set_pace(rate)
            case NoteInterest(zid, subscriptions):
                bridge.demand.note_robot(zid, subscriptions)

    def _tell(self, command: _ToOthers) -> None:
        match command:
            case SendDigest(digest):
                self.presence.send_digest(digest)
            case SendState(state, update):
                self.presence.send_state(state, update)
            case AskState(name, tag):
                self.presence.ask_state(name, tag)
            case TellBacklog(to, number, keys, grows):
                self.presence.tell_backlog(to, number, keys, grows=grows)

    def _reread(self, sample: int, key: str) -> None:
        held = self.bridge.payloads.waiting(sample)
        if held is None:
            self.loop.post(SampleRefused(clock.monotonic(), sample))
            return
        event = SampleReread(clock.monotonic(), sample, {})
        self.extractor.reread(event, key, held.sample.payload, held.sample.attachment)
