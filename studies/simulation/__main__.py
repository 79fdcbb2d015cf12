"""The command: `python -m studies.simulation`, one line of figures for each flight."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from time import process_time

from studies.simulation.clocks import Clock
from studies.simulation.flights import Conditions, draw, fly, scenario
from studies.simulation.scores import measure, reached, same_decisions, use


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly the missions asked for, and print what they reached."""
    options = _parser().parse_args(arguments)
    how = Conditions(
        coordination=options.coordination,
        transport=options.transport,
        limit=options.limit,
        latency=options.latency,
        jitter=options.jitter,
        loss=options.loss,
        duplication=options.duplication,
        reordering=options.reordering,
        seconds=options.seconds,
        robots=options.robots,
        iterations=options.iterations,
        digests_inside=options.digests_inside,
    )
    for name in ("few", "mixed", "most") if options.workload == "all" else (options.workload,):
        for seed in range(options.seed, options.seed + options.seeds):
            print(_line(name, seed, how, options.skew), flush=True)
    return 0


def _line(name: str, seed: int, how: Conditions, skew: float) -> str:
    flown = draw(scenario(name), seed, how)
    begin = process_time()
    team = fly(flown, how, seed)
    took = process_time() - begin
    marks, used, worth = measure(flown, how, seed), use(team, how), reached(flown, team)
    figures = [
        f"{name:5} seed {seed} {how.coordination} {how.transport} r={how.limit}",
        f"of bound {100 * worth / marks.bound:.1f} % (central {100 * marks.central / marks.bound:.1f} %)",
        f"of central {100 * worth / marks.central:.1f} %",
        f"sent {used.messages:.2f}/s of {how.limit / 2.5:.2f}/s",
        f"exceeding {100 * used.exceeding:.1f} % by {used.worst}",
        f"digests {used.digests:.0f} B/s",
    ]
    if skew:
        clocks = {f"r{i}": Clock(offset=skew * (-1) ** i, wall=skew * (-1) ** i) for i in range(how.robots)}
        wrong = fly(flown, replace(how, clocks=clocks), seed)
        figures.append(
            f"same with clocks off {100 * same_decisions(team.deliveries, wrong.deliveries, flown.frames):.1f} %"
        )
    return " | ".join([*figures, f"{took:.1f} s CPU"])


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m studies.simulation", description=__doc__)
    add = parser.add_argument
    add("--coordination", choices=("shares", "overhear"), default="shares")
    add("--transport", choices=("unicast", "broadcast"), default="unicast")
    add("--workload", choices=("few", "mixed", "most", "all"), default="all", help="scenario")
    add("--limit", type=int, default=5, help="messages per 2.5 s")
    add("--latency", type=float, default=0.02, help="[s]")
    add("--jitter", type=float, default=0.0, help="of the latency, mean [s]")
    add("--loss", type=float, default=0.0)
    add("--duplication", type=float, default=0.0)
    add("--reordering", type=float, default=0.0)
    add("--seconds", type=float, default=60.0, help="scored, after 10 s of warm-up")
    add("--robots", type=int, default=10)
    add("--iterations", type=int, default=300)
    add("--seed", type=int, default=0, help="the first one")
    add("--seeds", type=int, default=1)
    add("--skew", type=float, default=0.0, help="fly again with clocks off by so much, one way and the other [s]")
    add("--digests-inside", action="store_true", help="digests use of the limit, too")
    return parser


if __name__ == "__main__":
    sys.exit(main())
