"""Scores as tables: in a terminal, and as the page of the leaderboard."""

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from statistics import fmean

from proxy.printable import clean
from studies.bench.flying import BUILT_IN, Score
from studies.bench.folder import checksum, load
from studies.benchmarks.report import Table, machine

RULES = """\
Every robot decides for itself, by its own samples and by what it heard of the others'. The channel carries what the
limits allow: a sample that exceeds one is lost, and its sender is not told. Utility is a part of the bound: what
somebody who knew everything beforehand could have gained at most at the same latency, if nothing were lost on the way.
The *score* is the utility less as large a part of it as exceeded a limit of all that was sent, for others want to use
that channel, too. [studies/bench/README.md](../bench/README.md) has the rules, the format of missions, and how to write
a policy."""
NOTE = (
    "Means over missions [%]: score; utility as a part of the bound; samples sent; of those sent, over a limit. Of"
    " decisions the median and the 99th percentile of their processor time [ms]; told: what all robots tell each other"
    " besides samples [B/s]."
)


def summary(scores: Sequence[Score]) -> Table:
    """Return a row for each policy, the best first: means over missions."""
    rows = []
    for name in ranked(scores):
        own = [score for score in scores if score.policy == name]
        robots = fmean(score.told for score in own)
        cells = [
            *(
                f"{100 * fmean(getattr(score, what) for score in own):.1f}"
                for what in ("score", "utility", "sent", "over")
            ),
            *(f"{1000 * fmean(score.decision[k] for score in own):.2f}" for k in (0, 1)),
            f"{robots:.0f}",
        ]
        rows.append((name, *cells))
    columns = ("policy", "score", "utility", "sent", "over", "p50", "p99", "told")
    return Table("Policies", columns, tuple(rows), NOTE)


def by_mission(scores: Sequence[Score]) -> Table:
    """Return the score of each policy in each mission."""
    policies = ranked(scores)
    found = {(score.mission, score.policy): score for score in scores}
    rows = [
        (clean(name), *(_cell(found[name, policy]) for policy in policies))
        for name in dict.fromkeys(score.mission for score in scores)
    ]
    note = "Score [%]; behind it, where it is less than that, the utility."
    return Table("Missions", ("mission", *policies), tuple(rows), note)


def ranked(scores: Sequence[Score]) -> list[str]:
    """Return the policies by their mean score, the best first."""
    own: dict[str, list[float]] = {}
    for score in scores:
        own.setdefault(score.policy, []).append(score.score)
    return sorted(own, key=lambda name: -fmean(own[name]))


def text(scores: Sequence[Score]) -> str:
    """Write scores for a terminal."""
    return f"{summary(scores).text()}\n\n{by_mission(scores).text()}"


def write_page(path: Path, scores: Sequence[Score], missions: Sequence[Path], now: datetime) -> None:
    """Write the leaderboard; folders are made as needed."""
    builtin = [name for name in ranked(scores) if name in BUILT_IN]
    sections = [
        "# Leaderboard",
        f"Written by `sendworthy bench` on {now:%Y-%m-%d %H:%M} UTC. {machine()}.",
        RULES,
        summary(scores).markdown(),
        "\n".join(f"- `{name}`: {BUILT_IN[name].about}" for name in builtin),
        by_mission(scores).markdown(),
        _flown(missions).markdown(),
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join(filter(None, sections)) + "\n", encoding="utf-8")


def _cell(score: Score) -> str:
    whole, part = f"{100 * score.utility:.1f}", f"{100 * score.score:.1f}"
    return part if whole == part else f"{part} ({whole})"


def _flown(missions: Sequence[Path]) -> Table:
    """Say what the missions are, so that scores are compared of the same ones alone."""
    rows = []
    for path in missions:
        mission = load(path)
        head = mission.head
        rows.append(
            (
                head.name,
                f"{len(mission.robots)}",
                f"{len(mission.rows):,}",
                f"{head.seconds:g}",
                f"{1000 * head.latency:g}",
                f"{100 * head.loss:g}",
                f"{100 * head.bound / head.all:.0f}",
                checksum(path)[:12],
                head.about,
            )
        )
    columns = ("mission", "robots", "samples", "[s]", "latency [ms]", "loss [%]", "bound [%]", "SHA-256", "what it is")
    note = "The bound is a part of what all samples would be worth if nothing limited them."
    return Table("What was flown", columns, tuple(rows), note)
