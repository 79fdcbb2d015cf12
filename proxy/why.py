"""What somebody asks about the last decisions, and the daemon's answer: which streams are meant, and what it knows."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import zenoh

from proxy.core.model.mode import Mode, in_force
from proxy.core.samples.tuning import TUNING as SAMPLES
from proxy.errors import ProxyError
from proxy.tuning import TUNING
from utility_specs.suggestions import hint, listed, quoted

if TYPE_CHECKING:  # who asks needs no core
    from proxy.core.core import Core

VERSION = 1
"""Of the JSON form: new fields do not change it, others that mean something else do."""
MOST_NAMED = 20
"""Keys that are named where none is meant."""
LAST = (1, SAMPLES.entries)
"""How many decisions on a stream can be asked for."""


class QuestionError(ProxyError):
    """A question that nobody can answer."""


@dataclass(frozen=True, slots=True)
class Question:
    """The `last` decisions on the streams of `key` with a number above `after`.

    The key may be a key expression, or a part of one key. Raises QuestionError.
    """

    key: str
    last: int = 3
    after: int = 0

    def __post_init__(self) -> None:
        least, most = LAST
        if not least <= self.last <= most:
            raise QuestionError(f"the last {least} to {most} decisions on a stream are kept, not {self.last}")
        if not self.key:
            raise QuestionError("the key is empty")
        try:
            self.key.encode()
        except UnicodeEncodeError:
            raise QuestionError(f"the key {quoted(self.key)} is not UTF-8") from None

    def write(self) -> bytes:
        """Return what `read` reads."""
        return json.dumps(asdict(self)).encode()


def read(raw: bytes) -> Question:
    """Read a question. Raises QuestionError."""
    try:
        asked = json.loads(raw)
        return Question(str(asked["key"]), int(asked.get("last", 3)), int(asked.get("after", 0)))
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError):
        raise QuestionError('decisions are asked for with {"key": "robot/r1/camera", "last": 3, "after": 0}') from None


def answer(core: Core, now: float, question: Question) -> dict[str, Any]:
    """Return what the core knows of the streams that are meant as plain JSON data; `problem` says why of none."""
    asked = question.key  # most often one key, by who follows it again and again: then the others need no look
    keys = [asked] if _is_decided(core, asked) else meant(asked, core.decided_keys())
    told = keys[: TUNING.streams_told]
    last = max(1, min(question.last, TUNING.decisions_told // max(len(told), 1)))
    return {
        "version": VERSION,
        "robot": core.settings.robot,
        "mode": core.gate.appraisal.mode.value,
        "asked": question.key,
        "decided": core.gate.decisions.log.noted,
        "streams": [core.why(now, key, last, question.after) for key in told],
        "left_out": keys[len(told) :],
        "problem": None if keys else _problem(core, question.key),
    }


def _is_decided(core: Core, key: str) -> bool:
    """Whether decisions are made on a key of ours, or were lately."""
    return bool(core.gate.decisions.log.of(key)) or core.view.streams.known(core.settings.robot, key) is not None


def meant(asked: str, known: list[str]) -> list[str]:
    """Return the known keys that are meant: those that the key expression matches, or the only one that contains it."""
    from proxy.core.view.subscribers import intersects  # noqa: PLC0415 - who asks needs no core

    expression = _expression(asked)
    matched = [] if expression is None else [key for key in known if intersects(str(expression), key)]
    parts = [key for key in known if asked in key]
    return matched or (parts if len(parts) == 1 else [])


def _problem(core: Core, asked: str) -> str:
    """Say why nothing is known of what was asked for."""
    others = sorted({each.robot for each in core.view.streams if each.key == asked})
    if others:
        return (
            f"{quoted(asked)} is published by robot {', '.join(others)}, whose own daemon decides on it: ask that one"
        )
    known = core.decided_keys()
    parts = [key for key in known if asked in key]
    if parts:
        more = f" and {len(parts) - MOST_NAMED} more" if len(parts) > MOST_NAMED else ""
        return f"{quoted(asked)} is a part of several keys: {listed(parts[:MOST_NAMED])}{more}"
    what = f"no decision was made on {quoted(asked)}{hint(asked, known[:MOST_NAMED])}"
    expression = _expression(asked)
    if expression is None or "*" in asked:
        return what
    return f"{what}; {_undecided(core, asked)}"


def _undecided(core: Core, key: str) -> str:
    """Say why there may be no decision on samples of a key; what the bridge denies or lets pass only that knows."""
    covering = core.view.specs.match(key)
    if covering is None:
        return "no information type covers such a key: its samples pass undecided, unless bridge.out denies them"
    if covering.bypass:
        return f"information type {quoted(covering.name)} bypasses the planner, so its samples pass at once"
    if in_force(core.gate.appraisal.mode, covering.mode) is Mode.PASS:
        return f"in mode pass samples of information type {quoted(covering.name)} pass at once"
    return "no sample of it came, nobody on another robot wants it, or bridge.out denies it or lets it pass"


def _expression(text: str) -> zenoh.KeyExpr | None:
    try:
        return zenoh.KeyExpr.autocanonize(text)
    except zenoh.ZError:
        return None
