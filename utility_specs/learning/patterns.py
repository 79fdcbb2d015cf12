"""Which streams are of one kind: the same from several robots, or several of one robot with numbers in their keys.

Chunks that differ by digits alone (`r1`, `r2`) are of one kind where the traffic is alike at all. Chunks that are words
(`alice`, `bob`) must be followed by another chunk and have much the same traffic, for whatever follows both.
"""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import zenoh

from utility_specs.key_formats import MOST_WILD
from utility_specs.learning.formats import ros_topic
from utility_specs.learning.stream import Stream

SAME = 3.0
"""Streams whose keys differ in words are alike when sizes and rates differ by less than this factor;"""
SIMILAR = 10.0
"""where they differ in numbers, by less than this."""
UNIFORM = 1.2
"""Sizes of samples of which nothing is known say what they are."""
FEW = 4
"""So many samples tell no rate."""
MOST_KEYS = 64
"""Keys of one type, where no pattern will do."""
ROBOT = "robot"
"""What chunks that are names of robots are captured as."""

_NUMBER = re.compile(r"\d+")
_ID = re.compile(r"[0-9a-fA-F-]{8,}")

Form = tuple[str, ...]
"""The chunks of a key without what differs between streams of one kind."""


@dataclass(frozen=True, slots=True)
class Kind:
    """Streams of one kind, and the key expressions that cover them.

    `words` are the chunks that all keys have in common and that tell what it is, of which the last `telling` do for a
    name unless it is taken. With `yields` the keys cover streams of other kinds, too, which must come first in a spec.
    """

    keys: tuple[str, ...]
    streams: tuple[Stream, ...]
    words: tuple[str, ...]
    telling: int
    yields: bool = False

    @property
    def bytes(self) -> int:
        """Bytes of all its samples."""
        return sum(stream.bytes for stream in self.streams)


def kinds_of(streams: Sequence[Stream], robots: Collection[str] = ()) -> list[Kind]:
    """Return the kinds of streams; chunks that are names in `robots` stand for all robots, and are captured."""
    groups: dict[Form, list[list[Stream]]] = defaultdict(list)
    for stream in streams:
        _join(groups[_form(stream.key, robots)], stream)
    merged = _merged({form: split[0] for form, split in groups.items() if len(split) == 1})
    merged += [group for split in groups.values() if len(split) > 1 for group in split]
    return [_kind(group, [s.key for other in merged if other is not group for s in other], robots) for group in merged]


def _form(key: str, robots: Collection[str]) -> Form:
    forms = ("#" if _is_id(chunk) else _NUMBER.sub("#", chunk) for chunk in key.split("/"))
    return tuple("#robot" if form in robots else form for form in forms)


def _is_id(chunk: str) -> bool:
    return bool(_ID.fullmatch(chunk)) and any(sign.isdigit() for sign in chunk)


def _join(groups: list[list[Stream]], stream: Stream) -> None:
    """Put a stream to those like it; streams of one key stay together, whoever publishes them."""
    at_home = [group for group in groups if any(stream.key == other.key for other in group)]
    for group in at_home or groups:
        if at_home or alike(stream, group[0], SIMILAR):
            group.append(stream)
            return
    groups.append([stream])


def alike(a: Stream, b: Stream, factor: float) -> bool:
    """Whether two streams could be the same of two robots: format, content, sizes and rates."""
    if a.format != b.format:
        return False
    shows, other = set(a.shows), set(b.shows)
    if shows or other:
        content = 2 * len(shows & other) >= len(shows | other)
    else:
        content = a.format != "raw" or _within(a.size, b.size, max(UNIFORM, factor / SAME))
    rates = min(a.count, b.count) <= FEW or _within(a.interval, b.interval, factor)
    often = factor > SAME or max(a.count, b.count) <= FEW * SIMILAR or min(a.count, b.count) > FEW
    return content and rates and often and _within(a.size, b.size, factor)


def _within(a: float, b: float, factor: float) -> bool:
    return max(a, b) <= factor * max(min(a, b), 1e-9) or max(a, b) == 0.0


def _merged(groups: dict[Form, list[Stream]]) -> list[list[Stream]]:
    """Merge groups whose keys differ in one word, for whatever stands beside it in both."""
    for place in range(max((len(form) for form in groups), default=0)):
        words: dict[int, dict[str, dict[Form, list[Stream]]]] = defaultdict(lambda: defaultdict(dict))
        for form, group in groups.items():
            if place < _inner(group[0].key):
                words[len(form)][form[place]][form[:place] + form[place + 1 :]] = group
        for by_word in words.values():
            for same in _classes(by_word):
                for word in same[1:]:
                    for rest in by_word[word]:
                        gone = (*rest[:place], word, *rest[place:])
                        stays = (*rest[:place], same[0], *rest[place:])
                        groups[stays] = groups.get(stays, []) + groups.pop(gone)
    return list(groups.values())


def _inner(key: str) -> int:
    """Return how many chunks are followed by one that says what they are."""
    topic = ros_topic(key)
    return key.count("/") if topic is None else 1 + topic.count("/")


def _classes(by_word: dict[str, dict[Form, list[Stream]]]) -> Iterable[list[str]]:
    """Return words that are names of the same kind of thing, in classes."""
    classes: list[list[str]] = []
    for word, rests in by_word.items():
        for same in classes:
            shared = by_word[same[0]].keys() & rests.keys()
            if shared and all(alike(by_word[same[0]][rest][0], rests[rest][0], SAME) for rest in shared):
                same.append(word)
                break
        else:
            classes.append([word])
    return classes


def _kind(group: Sequence[Stream], others: Iterable[str], robots: Collection[str]) -> Kind:
    """Return the kind of a group, with the widest keys that cover no other stream."""
    each = tuple(dict.fromkeys(stream.key for stream in group))
    chunks = list(zip(*(key.split("/") for key in each), strict=True))
    topic = ros_topic(each[0])
    differ = [len(set(column)) > 1 or column[0] in robots for column in chunks]
    differ[-1] = differ[-1] or topic is not None  # the hash of the type
    own, taken = ([zenoh.KeyExpr(key) for key in keys] for keys in (each, others))
    keys, yields = each[:MOST_KEYS], False
    for wildcard in (_numbered, _any):  # the second is the wider one
        text = "/".join(wildcard(c) if d else c[0] for c, d in zip(chunks, differ, strict=True))
        if text.count("$*") > MOST_WILD:
            continue
        pattern = zenoh.KeyExpr(text)
        alone = not any(map(pattern.includes, taken))
        if all(map(pattern.includes, own)) and (alone or len(each) > MOST_KEYS):
            keys, yields = (_captured(text, chunks, robots),), not alone
    inner = range(1, len(chunks) - 2) if topic is not None else range(len(chunks))
    words = [place for place in inner if not differ[place]]
    last = max((place for place in inner if differ[place]), default=inner[-1] - 1)
    return Kind(keys, tuple(group), tuple(chunks[p][0] for p in words), max(1, sum(p > last for p in words)), yields)


def _captured(text: str, chunks: Sequence[Sequence[str]], robots: Collection[str]) -> str:
    """Give the first chunk a name that stands for a robot, if any is known to."""
    written = text.split("/")
    for place, column in enumerate(chunks):
        if written[place] == "*" and any(chunk in robots for chunk in column):
            written[place] = f"${{{ROBOT}:*}}"
            break
    return "/".join(written)


def _any(column: Sequence[str]) -> str:  # noqa: ARG001 - whatever it is
    return "*"


def _numbered(column: Sequence[str]) -> str:
    """Return what chunks that differ in a number have in common, as a part of a key expression."""
    forms = {_NUMBER.sub("$*", chunk) for chunk in column}
    return forms.pop() if len(forms) == 1 and "$*" not in forms else "*"
