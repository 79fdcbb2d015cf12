"""The command: `python -m studies.simulation`, one line of figures for each flight."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from time import process_time

from studies.simulation.clocks import Clock
from studies.simulation.conditions import Conditions
from studies.simulation.flights import fly, team
from studies.simulation.forecasts import Probe
from studies.simulation.missions import Mission, Sizes, draw, scenario
from studies.simulation.scores import measure, reached, same_decisions, sent
from studies.simulation.team import Team
from studies.simulation.usage import usage


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly the missions asked for, and print what they reached."""
    options = vars(_parser().parse_args(arguments))
    name, first, seeds, skew, sizes = (options.pop(o) for o in ("workload", "seed", "seeds", "skew", "sizes"))
    how = Conditions(**options)
    for each in ("few", "mixed", "most") if name == "all" else (name,):
        for seed in range(first, first + seeds):
            print(_line(each, seed, how, skew, sizes), flush=True)
    return 0


def _line(name: str, seed: int, how: Conditions, skew: float, sizes: Sizes) -> str:
    flown, probe = draw(scenario(name), seed, how, sizes), Probe()
    begin = process_time()
    flight = team(flown, how, seed)
    probe.attach(flight, flown.frames)
    flight.run(flown.frames, flown.problem.t_end)
    took = process_time() - begin
    marks, used, worth = measure(flown, how.iterations), usage(flown, flight, how), reached(flown, flight)
    central = marks.central(flown, how.loss, seed)
    figures = [
        f"{name:5} seed {seed} {how.coordination} {how.transport} r={how.limit}",
        f"of central {100 * worth / central:.1f} %",
        f"of bound {100 * worth / marks.bound:.1f} % (central {100 * central / marks.bound:.1f} %)",
        f"sent {used.messages:.2f}/s",
        f"exceeding {100 * used.exceeding:.1f} % by {used.worst}, with digests {100 * used.together:.1f} %",
        f"told {used.told:.0f} B/s, a digest in {used.interval:.1f} s",
        f"forecasts off by {100 * probe.others.summary()[0]:.1f} % (own {100 * probe.own.summary()[0]:.1f} %)",
    ]
    if skew:
        figures.append(f"same with clocks off {100 * _same(how, skew, seed, flight, flown):.1f} %")
    return " | ".join([*figures, f"{took:.1f} s CPU"])


def _same(how: Conditions, skew: float, seed: int, right: Team, flown: Mission) -> float:
    clocks = {f"r{i}": Clock(offset=skew * (-1) ** i, wall=skew * (-1) ** i) for i in range(how.robots)}
    wrong = fly(flown, replace(how, clocks=clocks), seed)
    return same_decisions(flown, sent(flown, right), sent(flown, wrong))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m studies.simulation", description=__doc__)
    add = parser.add_argument
    add("--coordination", choices=("announce", "split"), default="announce")
    add("--transport", choices=("unicast", "broadcast"), default="unicast")
    add("--workload", choices=("few", "mixed", "most", "all"), default="all", help="scenario")
    add("--sizes", choices=("equal", "mixed"), default="equal", help="of messages: 2,048 B, or 0.2 to 50 kB")
    add("--limit", type=int, default=5, help="messages per 2.5 s, of 25")
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
    add("--clock-error", type=float, default=0.0, help="wall clocks are known to be right but for this [s]")
    add("--digests-inside", action="store_true", help="digests use of the limit, too")
    add("--digests-by-unicast", dest="digests_on_air", action="store_false", help="also where samples are broadcast")
    return parser


if __name__ == "__main__":
    sys.exit(main())
