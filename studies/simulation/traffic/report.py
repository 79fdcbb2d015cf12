"""What the comparison prints: a line for each flight, and a table."""

from collections.abc import Iterable, Sequence
from statistics import fmean

from studies.simulation.traffic.comparison import Result
from studies.simulation.traffic.scores import Score

Key = tuple[str, int, float, int]


class Marks:
    """Utilities to compare with, as far as they are known: of central deciders by cell, of bounds whatever the loss."""

    def __init__(self, results: Iterable[Result] = ()) -> None:
        self._central: dict[object, float] = {}
        self._bound: dict[Key, float] = {}
        for result in results:
            self.add(result)

    def add(self, result: Result) -> None:
        """Remember the result if others are compared with it."""
        if result.task.contender == "central":
            self._central[result.task.cell] = result.utility
        if result.task.contender == "bound":
            self._bound[_key(result)] = result.utility

    def shares(self, result: Result) -> tuple[float | None, float | None]:
        """Return the utility as a part of the central decider's and of the bound."""
        central, bound = self._central.get(result.task.cell), self._bound.get(_key(result))
        return (result.utility / central if central else None, result.utility / bound if bound else None)


def line(result: Result, marks: Marks) -> str:
    """Return all figures of one flight."""
    task = result.task
    figures = [f"{task.cell.label} seed {task.cell.seed} {task.contender}", *_utility(result, marks)]
    if result.score is None:
        figures.append(f"sent {result.sent / 1000:.0f} kB")
    else:
        figures += _figures(result.score)
    milliseconds = 1000 * result.cpu / max(result.samples, 1)
    figures.append(f"{result.cpu:.1f} s CPU, {milliseconds:.2f} ms a sample")
    return " | ".join(figures + [result.note] * bool(result.note))


def _utility(result: Result, marks: Marks) -> list[str]:
    central, bound = marks.shares(result)
    return [f"of central {_percent(central)}, of bound {_percent(bound)} ({result.utility:.1f})"]


def _figures(score: Score) -> list[str]:
    figures = [
        f"fill {_percent(score.fill)} ({score.sent / 1000:.0f} kB)",
        f"over {_percent(score.over)}, worst {score.worst:.2f}",
        f"told {score.told:.0f} B/s (digests {score.digests:.0f})",
        f"silent {max(score.silence.values(), default=0.0):.1f} s",
    ]
    if score.has_small:
        figures.append(
            f"small arrived {_percent(score.arrived)}, sent {_percent(score.kept)}, "
            f"age {1000 * score.age[0]:.0f} / {1000 * score.age[1]:.0f} ms"
        )
    if score.alarms:
        figures.append(f"alarms {score.alarms_sent}/{score.alarms}")
    return figures


HEAD = (
    "workload, latency, loss",
    "contender",
    "of central",
    "of bound",
    "fill",
    "windows over",
    "fullest",
    "small arrived (sent)",
    "age p50 / p95",
    "alarms",
    "told",
    "longest silence",
    "time a sample",
)


def table(results: Sequence[Result]) -> str:
    """Return a Markdown table, a row for each contender under the same conditions, means over seeds."""
    marks = Marks(results)
    rows: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        rows.setdefault((result.task.cell.label, result.task.contender), []).append(result)
    lines = [HEAD, ("---", "---", *["--:"] * (len(HEAD) - 2))]
    lines += [(*who, *_row(own, marks)) for who, own in rows.items()]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


def _row(results: Sequence[Result], marks: Marks) -> list[str]:
    shares = [marks.shares(result) for result in results]
    central = [share for share, _ in shares if share is not None]
    bound = [share for _, share in shares if share is not None]
    cost = fmean(1000 * result.cpu / max(result.samples, 1) for result in results)
    scores = [result.score for result in results if result.score is not None]
    cells = [_percent(fmean(each) if each else None) for each in (central, bound)]
    if not scores:
        sent = fmean(result.sent for result in results)
        return [*cells, f"{sent / 1000:.0f} kB", *["–"] * 7, f"{cost:.2f} ms"]
    small, alarms = scores[0].has_small, sum(score.alarms for score in scores)
    return [
        *cells,
        _percent(fmean(score.fill for score in scores)),
        _percent(fmean(score.over for score in scores)),
        f"{max(score.worst for score in scores):.2f}",
        f"{_percent(fmean(s.arrived for s in scores))} ({_percent(fmean(s.kept for s in scores))})" if small else "–",
        " / ".join(f"{1000 * fmean(s.age[i] for s in scores):.0f}" for i in (0, 1)) + " ms" if small else "–",
        f"{sum(score.alarms_sent for score in scores)}/{alarms}" if alarms else "–",
        f"{fmean(score.told for score in scores):.0f} B/s",
        f"{max(max(score.silence.values()) for score in scores):.1f} s",
        f"{cost:.2f} ms",
    ]


def _percent(part: float | None) -> str:
    return "–" if part is None else f"{100 * part:.1f} %"


def _key(result: Result) -> Key:
    cell = result.task.cell
    return cell.workload, cell.robots, cell.latency, cell.seed
