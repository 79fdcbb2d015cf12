"""What the comparison prints: a line for each flight, and tables."""

from collections.abc import Callable, Sequence
from functools import partial
from statistics import fmean, stdev

from studies.benchmarks.report import Table
from studies.simulation.traffic.comparison import Result
from studies.simulation.traffic.marks import Marks
from studies.simulation.traffic.scores import Score
from studies.simulation.traffic.targets import target_table

T_95 = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78, 6: 2.57, 8: 2.36, 10: 2.26}
"""Student's t by the number of seeds, for intervals of 95 %."""


def line(result: Result, marks: Marks) -> str:
    """Return all figures of one flight."""
    task = result.task
    figures = [f"{task.cell.label} seed {task.cell.seed} {task.contender}", *_utility(result, marks)]
    if result.score is None:
        figures.append(f"sent {result.sent / 1000:.0f} kB")
    else:
        figures += _figures(result.score, marks.large(result))
    milliseconds = 1000 * result.cpu / max(result.samples, 1)
    figures.append(f"{result.cpu:.1f} s CPU, {milliseconds:.2f} ms a sample")
    return " | ".join(figures + [result.note] * bool(result.note))


def _utility(result: Result, marks: Marks) -> list[str]:
    central, bound = marks.of_central(result), marks.of_bound(result)
    return [f"of central {_percent(central)}, of bound {_percent(bound)} ({result.utility:.1f})"]


def _figures(score: Score, large: float | None) -> list[str]:
    figures = [
        f"fill {_percent(score.fill)} ({score.sent / 1000:.0f} kB)",
        f"over {_percent(score.over)}, worst {score.worst:.2f}",
        f"told {score.told:.0f} of {score.allowed:.0f} B/s (digests {score.digests:.0f})",
        f"silent {max(score.silence.values(), default=0.0):.1f} s",
    ]
    if score.has_small:
        figures += [
            f"large {_percent(large)} of central",
            f"small arrived {_percent(score.arrived)}, sent {_percent(score.kept)}",
            f"age {1000 * score.age[0]:.0f} / {1000 * score.age[1]:.0f} ms",
        ]
    if score.alarms:
        figures.append(f"alarms {score.alarms_sent}/{score.alarms}")
    return figures


def tables(results: Sequence[Result]) -> list[Table]:
    """Return the targets, and three tables a workload: a row for each latency and loss, a column for each contender."""
    marks, groups = Marks(results), dict[str, list[Result]]()
    for result in results:
        groups.setdefault(f"{result.task.cell.workload}, {result.task.cell.robots} robots", []).append(result)
    found = [target_table(results)]
    for name, group in groups.items():
        found += [
            _table(f"{name}: utility and windows", group, partial(_worth, marks), UTILITY),
            _table(f"{name}: use, words, silence, time", group, _use, USE),
        ]
        if any(result.score and result.score.has_small for result in group):
            found.append(_table(f"{name}: large and small samples, alarms", group, partial(_small, marks), SMALL))
    return found


UTILITY = (
    "Of the central decider (of the bound), %, with half the width of its 95 % interval where there are several seeds "
    "/ samples whose window exceeds the limit, %, and the fullest window, in limits."
)
USE = (
    "Bytes sent of what limit or offer allow, %, or in kB for bounds and plans / what the team tells of what "
    "it may, % / longest silence of a robot, s / processor time a sample, ms."
)
SMALL = (
    "Utility of what is not small, of the central decider's, % / small samples that arrived (were sent), % / their "
    "age, median and 95th percentile, ms / alarms sent."
)


def _table(title: str, results: Sequence[Result], cell: Callable[[Sequence[Result]], str], note: str) -> Table:
    rows: dict[str, dict[str, list[Result]]] = {}
    contenders = dict.fromkeys(result.task.contender for result in results)
    for result in results:
        label = result.task.cell.label.partition(" ")[2]
        rows.setdefault(label, {}).setdefault(result.task.contender, []).append(result)
    cells = ((label, *(cell(row[name]) if name in row else "" for name in contenders)) for label, row in rows.items())
    return Table(title, ("latency, loss", *contenders), tuple(cells), note)


def _worth(marks: Marks, results: Sequence[Result]) -> str:
    central, bound = (
        [100 * share for share in map(of, results) if share is not None] for of in (marks.of_central, marks.of_bound)
    )
    text = f"{_mean(central)}{_interval(central)} ({_mean(bound)})"
    scores = _scores(results)
    if not scores:
        return text
    return f"{text} / {100 * fmean(s.over for s in scores):.1f}, {max(s.worst for s in scores):.2f}"


def _use(results: Sequence[Result]) -> str:
    cost = fmean(1000 * result.cpu / max(result.samples, 1) for result in results)
    scores = _scores(results)
    if not scores:
        return f"{fmean(result.sent for result in results) / 1000:.0f} kB"
    silence = max(max(score.silence.values(), default=0.0) for score in scores)
    fill, told = (fmean(each) for each in zip(*((100 * s.fill, 100 * s.told / s.allowed) for s in scores), strict=True))
    return f"{fill:.1f} / {told:.0f} / {silence:.1f} / {cost:.2f}"


def _small(marks: Marks, results: Sequence[Result]) -> str:
    scores = _scores(results)
    if not scores:
        return ""
    large = [100 * share for share in map(marks.large, results) if share is not None]
    arrived, kept = (100 * fmean(each) for each in zip(*((s.arrived, s.kept) for s in scores), strict=True))
    median, late = (1000 * fmean(score.age[i] for score in scores) for i in (0, 1))
    alarms = f"{sum(s.alarms_sent for s in scores)} of {sum(s.alarms for s in scores)}"
    return f"{_mean(large)} / {arrived:.1f} ({kept:.1f}) / {median:.0f}, {late:.0f} / {alarms}"


def _scores(results: Sequence[Result]) -> list[Score]:
    return [result.score for result in results if result.score is not None]


def _mean(values: Sequence[float]) -> str:
    return f"{fmean(values):.1f}" if values else "–"


def _interval(values: Sequence[float]) -> str:
    """Return half the width of the 95 % interval of the mean (Student's t)."""
    if len(values) < min(T_95):
        return ""
    factor = T_95.get(len(values), 2.0)
    return f" ± {factor * stdev(values) / len(values) ** 0.5:.1f}"


def _percent(part: float | None) -> str:
    return "–" if part is None else f"{100 * part:.1f} %"
