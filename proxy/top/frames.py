"""What stands on the screen: lines with a style, from what daemons say and what is wanted."""

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from proxy.printable import clean
from proxy.quantities import UNKNOWN, Status, amount, duration, number, share
from proxy.status.columns import Table, fitted, shortened
from proxy.status.tables import PEERS
from proxy.status.text import ALONE, SHADOWED, headline, unspecified, wrapped
from proxy.status.warnings import warnings
from proxy.top.fleet import Changes, Robot, namesakes, robots, rows
from proxy.top.rates import DROPPED, Change
from proxy.top.tables import FLEET, LIVE
from proxy.top.view import KEYS, View

PLAIN, HEAD, GOOD, TIGHT, BAD, DIM, MARKED = "", "bold", "green", "yellow", "bold red", "dim", "reverse"
BAR, SHORT_BAR, NARROW = 20, 12, 100
FULL, NEARLY = 0.95, 0.75
WARNINGS, PEER_ROWS, LEAST_ROWS = 3, 6, 3
FOOTER = "q quit  ? help  f fleet  n next  s sort  r turn  / filter  a all"


class Line(NamedTuple):
    """A line and its style."""

    text: str
    style: str = PLAIN


@dataclass(frozen=True, slots=True)
class Scene:
    """What is known: what daemons said, and why nothing comes any more, if so."""

    changes: Changes
    away: str = ""


def frame(scene: Scene, view: View, width: int, height: int | None = None) -> list[Line]:
    """Return the lines of a screen; without a `height` all of them."""
    if view.help:
        return _help(view, width, height)
    found = robots(scene.changes)
    view.names = tuple(robot.name for robot in found)
    old = "; what is shown is what it said last" if found else ""
    above = [Line(line, BAD) for line in textwrap.wrap(scene.away + old, width) if scene.away]
    below = [Line(_footer(view)[:width], DIM)]
    shown = next((robot for robot in found if view.robot in (robot.name, robot.called)), None)
    view.found = bool(found) and (shown is not None or view.robot is None)
    if not found:
        return _filled([*above, *([] if scene.away else [Line("asking …", DIM)])], below, height)
    if not view.found:
        above.append(Line(f"robot {view.robot} is not known; there are {', '.join(view.names)}", BAD))
    room = None if height is None else height - len(above) - len(below)
    if view.fleet or not view.found:
        body = _fleet(found, view, width, room)
    else:
        body = _robot(shown or next(robot for robot in found if robot.itself), view, width, room)
    fits = [Line(shortened(line.text, width), line.style) for line in [*above, *body]]
    return _filled(fits, below, height)


def _filled(lines: Sequence[Line], below: Sequence[Line], height: int | None) -> list[Line]:
    """Return a whole screen, with the last lines at its end."""
    if height is None:
        return [*lines, *below]
    room = height - len(below)
    return [*lines[:room], *[Line("")] * (room - len(lines)), *below]


def _footer(view: View) -> str:
    if view.typing:
        return f"only rows with: {view.filter}_   enter: done   esc: all rows"
    chosen = f"  only {view.filter!r}" if view.filter else ""
    return f"by {view.sort}{', turned' * view.reverse}{chosen}   {FOOTER}"


def _help(view: View, width: int, height: int | None) -> list[Line]:
    lines = [Line("Keys", HEAD)]
    for key, meaning in KEYS.items():
        lines += map(Line, textwrap.wrap(meaning, width, initial_indent=f"  {key:9}", subsequent_indent=" " * 11))
    for table in (LIVE, FLEET):
        lines += [Line(line, HEAD) for line in textwrap.wrap(f"{table.title}: {table.means}", width)]
        for column in table.columns:
            begin = f"  {column.head:17}"
            lines += map(Line, textwrap.wrap(column.means, width, initial_indent=begin, subsequent_indent=" " * 19))
    if height is None:
        return lines
    view.at = min(view.at, max(0, len(lines) - height + 1))
    return _filled(lines[view.at :], [Line("up down: scroll   any other key: back"[:width], DIM)], height)


def _fleet(found: Sequence[Robot], view: View, width: int, room: int | None) -> list[Line]:
    chosen = view.chosen(list(rows(found)), "robot")
    view.mark([str(row["robot"]) for row in chosen])
    speakers = [robot.by.now for robot in found if robot.itself]
    speaker = max(speakers, key=lambda status: len(status.get("peers", ())))
    above = [Line(f"{len(found)} robots", HEAD), *_wrong(_warnings(found), width), *_limits(speaker, width)]
    fits = fitted(FLEET, chosen, width).lines()
    lines = [Line(fits[0], HEAD), *(Line(line, _of_row(row)) for line, row in zip(fits[1:], chosen, strict=True))]
    if room is not None and chosen:
        lines[view.at + 1] = Line(lines[view.at + 1].text, MARKED)
        first = max(0, view.at + 2 - max(LEAST_ROWS, room - len(above) - 1))
        lines = [lines[0], *lines[1 + first :]]
    return [*above, *lines]


def _robot(robot: Robot, view: View, width: int, room: int | None) -> list[Line]:
    now = robot.by.now
    above = [*_about(robot, width), *_limits(now, width)]
    if robot.itself:
        above += [*_samples(robot.by, width), *_planner(robot.by)]
    if now.get("mode") == "shadow":
        above += map(Line, wrapped(SHADOWED, width))
    streams = list(robot.by.streams()) if view.all_streams else robot.streams()
    chosen = view.chosen(streams, "key")
    known = now.get("peers", ()) if robot.itself else [robot.peer]
    peers = [Line(""), *(_table(PEERS, known, width) if known else map(Line, wrapped(ALONE, width)))]
    if room is None:
        return [*above, Line(""), *_table(LIVE, chosen, width), *peers]
    peers = peers[: PEER_ROWS + 2]
    left = max(LEAST_ROWS, room - len(above) - 2 - len(peers))
    view.settle(len(chosen), left)
    lines = _table(LIVE, chosen, width)
    shown = lines[1 + view.at : 1 + view.at + left]
    more = len(chosen) - view.at - len(shown)
    if more > 0:
        shown[-1] = Line(f"… and {more + 1} more", DIM)
    return [*above, Line(""), *lines[:1], *shown, *peers]


def _about(robot: Robot, width: int) -> Iterator[Line]:
    """Who it is, and what is wrong."""
    now = robot.by.now
    if not robot.itself:
        facts = f"mode {robot.peer.get('mode') or UNKNOWN}   version {robot.peer.get('version') or UNKNOWN}"
        yield Line(f"robot {clean(robot.name)}   {facts}   as robot {clean(str(now.get('robot')))} sees it", HEAD)
        return
    lines = headline({**now, "robot": robot.name}, width)
    yield from (Line(line, HEAD) for line in lines[:1])
    if (none := unspecified(now)) and none not in lines[0]:
        yield from (Line(line, TIGHT) for line in wrapped(clean(none), width))
    yield from _wrong(warnings(now), width)


def _warnings(found: Sequence[Robot]) -> list[str]:
    """What is wrong in the fleet, each thing once."""
    same = [f"several robots are called {name}: rename all but one" for name in namesakes(found)]
    said = [f"{robot.name}: {warning}" for robot in found if robot.itself for warning in warnings(robot.by.now)]
    return [*same, *said]


def _wrong(found: Sequence[str], width: int) -> Iterator[Line]:
    for warning in found[:WARNINGS]:
        yield from (Line(line, BAD) for line in wrapped(f"warning: {clean(warning)}", width, "  "))
    if len(found) > WARNINGS:
        yield Line(f"and {len(found) - WARNINGS} more warnings: see sendworthy status", BAD)


def _limits(now: Status, width: int) -> Iterator[Line]:
    """How full each limit is, and what room costs."""
    for limit in now.get("budget", ()):
        used, whole, unit = limit.get("used_by_all"), limit.get("limit"), limit.get("unit", "B")
        part = used / whole if used is not None and whole else 0.0
        bar = BAR if width > NARROW else SHORT_BAR
        full = round(bar * min(1.0, max(0.0, part)))  # in this order nothing, where the part is no number
        ours = share(limit.get("used"), whole)
        text = (
            f"{shortened(clean(str(limit.get('constraint', UNKNOWN))), 16)}  "
            f"[{('#' * full).ljust(bar)}] {share(used, whole)} of "
            f"{amount(whole, unit)} in {limit.get('window', 0.0):g} s, ours {ours}; "
            f"1 kB costs {number(limit.get('price_per_kb'))}"
        )
        style = BAD if part > FULL else TIGHT if part > NEARLY else GOOD
        yield from (Line(line, style) for line in textwrap.wrap(text, width, subsequent_indent="  "))


def _samples(change: Change, width: int) -> Iterator[Line]:
    """What becomes of samples in a second."""
    made, sent, dropped = (_rate(change.rate("counts", name)) for name in ("in", "forwarded", "dropped"))
    reasons = ", ".join(f"{word.removeprefix(DROPPED)} {rate:.1f}" for word, rate in change.dropped().items())
    why = f": {reasons}" if reasons else ""
    waiting = change.now.get("counts", {}).get("queued", 0)
    text = f"samples   {made}/s made, {sent}/s sent, {dropped}/s dropped{why}; {waiting} wait"
    yield from map(Line, textwrap.wrap(text, width, subsequent_indent=" " * 10))


def _planner(change: Change) -> Iterator[Line]:
    """How much the planner has to do, and how long it takes."""
    made, late, busy = (change.rate("decisions", name) for name in ("made", "late", "seconds"))
    each = duration(change.mean("decisions", "seconds", "made"))
    text = f"planner   {_rate(made)} decisions/s, {each} each, {share(busy, 1.0)} of a core, {_rate(late)}/s late"
    yield Line(text, TIGHT if late else PLAIN)


def _table(table: Table, found: Sequence[Status], width: int) -> list[Line]:
    head, *lines = fitted(table, found, width).lines()
    return [Line(head, HEAD), *(Line(line, _of_row(row)) for line, row in zip(lines, found, strict=True))]


def _of_row(row: Any) -> str:
    """Rows of whom takes no part are marked, and those of which something is dropped."""
    if not row.get("takes_part", True):
        return BAD
    return TIGHT if (row.get("unsent") or 0.0) > 0.05 else DIM if row.get("over") else PLAIN


def _rate(value: float | None) -> str:
    return UNKNOWN if value is None else f"{value:.1f}"
