"""The picture of a replay: four plots, which can be told apart in grey. Needs matplotlib, of the extra `study`."""

import re
from io import StringIO
from typing import Any

from studies.replay.samples import SENT
from studies.replay.table import limit_text, quantity

Report = dict[str, Any]
GREY, BLUE, ORANGE, LIGHT = "#666666", "#0072B2", "#D55E00", "#dddddd"
HATCHES = ("", "//", "..", "xx", "\\\\", "oo", "++", "**")
SHADES = ("#0072B2", "#E69F00", "#cccccc", "#D55E00", "#56B4E9", "#999999", "#009E73", "#CC79A7")
"""Of Okabe and Ito, which the colour-blind tell apart; hatches tell them apart in grey."""
MOST_TYPES = 14
"""Types in a plot; what is left out stands in the table."""
_OUTSIDE = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<metadata>.*?</metadata>| xmlns(:\w+)?=\"[^\"]*\"", re.DOTALL)


def picture(report: Report) -> str:
    """Draw the plots as one SVG element that refers to nothing outside of it. Raises ImportError."""
    import matplotlib as mpl  # noqa: PLC0415 - belongs to the extra "study"

    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415

    types = dict(sorted(report["types"].items(), key=lambda each: -each[1]["bytes_all"])[:MOST_TYPES])
    settings: Any = {"svg.fonttype": "none", "svg.hashsalt": "sendworthy", "font.size": 9, "font.family": "sans-serif"}
    with mpl.rc_context(settings):
        height = 6.0 + 0.28 * max(len(types), 3)
        figure, axes = plt.subplots(2, 2, figsize=(11, height), layout="constrained")
        _utility(axes[0][0], report)
        _bytes(axes[0][1], report)
        _fates(axes[1][0], types)
        _ages(axes[1][1], types)
        written = StringIO()
        figure.savefig(written, format="svg", metadata=dict.fromkeys(("Creator", "Date", "Format", "Type")))
        plt.close(figure)
    return _OUTSIDE.sub("", written.getvalue()).strip()


def _stairs(axes: Any, pieces: list[Report], name: str, **style: Any) -> None:
    """Draw what is gained or sent in each piece, per second."""
    edges = [pieces[0]["begin"], *(piece["end"] for piece in pieces)]
    axes.stairs([piece[name] / (piece["end"] - piece["begin"]) for piece in pieces], edges, baseline=None, **style)


def _utility(axes: Any, report: Report) -> None:
    _stairs(
        axes,
        report["course"],
        "utility_all",
        label="all sent, without limits",
        color=GREY,
        linestyle=":",
        linewidth=1.2,
    )
    if report["bound"] is not None:
        _stairs(
            axes,
            report["pieces"],
            "bound",
            label="offline bound, means",
            color="black",
            linestyle="--",
            linewidth=1.6,
            zorder=3,
        )
    _stairs(axes, report["course"], "utility", label="this replay", color=BLUE, linewidth=1.8)
    axes.set(title="Utility gained", xlabel="time [s]", ylabel="utility", ylim=(0, None))
    _framed(axes)
    axes.legend(fontsize=8, framealpha=0.85, edgecolor="none")


def _bytes(axes: Any, report: Report) -> None:
    course = [each | {name: 8e-6 * each[name] for name in ("bytes", "bytes_all")} for each in report["course"]]
    _stairs(axes, course, "bytes_all", label="published", color=GREY, linestyle=":", linewidth=1.2)
    _stairs(axes, course, "bytes", label="sent", color=BLUE, linewidth=1.8)
    for limit in report["limits"]:
        if limit["unit"] == "B":
            rate = 8e-6 * limit["limit"] / limit["window"]
            axes.axhline(rate, label=f"limit, {limit_text(limit)}", color="black", linestyle="--", linewidth=1.2)
    axes.set(title="On the air", xlabel="time [s]", ylabel="Mbit/s", ylim=(0, None))
    _framed(axes)
    axes.legend(fontsize=8, framealpha=0.85, edgecolor="none")


def _fates(axes: Any, types: Report) -> None:
    """Draw what became of the samples of each type, as parts."""
    totals: dict[str, int] = {}
    for figures in types.values():
        for reason, count in figures["reasons"].items():
            totals[reason] = totals.get(reason, 0) + count
    reasons = sorted(totals, key=lambda reason: (reason.startswith("dropped:"), reason != SENT, -totals[reason]))
    left = [0.0] * len(types)
    for number, reason in enumerate(reasons):
        parts = [100 * f["reasons"].get(reason, 0) / max(1, f["messages"]) for f in types.values()]
        style = {"color": SHADES[number % len(SHADES)], "hatch": HATCHES[number % len(HATCHES)]}
        axes.barh(range(len(types)), parts, left=left, label=reason, edgecolor="white", linewidth=0.4, **style)
        left = [a + b for a, b in zip(left, parts, strict=True)]
    names = [f"{_short(name)}\n{quantity(f['bytes_all'])}" for name, f in types.items()]
    axes.set_yticks(range(len(types)), names, fontsize=8)
    axes.invert_yaxis()
    axes.set(title="What became of the samples", xlabel="% of samples", xlim=(0, 100))
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3)


def _ages(axes: Any, types: Report) -> None:
    """Draw how old samples are when they arrive: from the median to the 95th percentile."""
    for place, figures in enumerate(types.values()):
        age = figures["age"]
        if age is not None:
            low, high = 1000 * age["median"], 1000 * age["p95"]
            axes.plot([low, high], [place, place], color=BLUE, linewidth=2)
            axes.plot([low], [place], "o", color=BLUE, markersize=6)
            axes.plot([high], [place], "|", color=ORANGE, markersize=13, markeredgewidth=2.5)
    axes.plot([], [], "o", color=BLUE, label="median")
    axes.plot([], [], "|", color=ORANGE, markersize=11, markeredgewidth=2.5, label="95th percentile")
    axes.set_yticks(range(len(types)), [_short(name) for name in types], fontsize=8)
    axes.set(title="Age at the receiver", xlabel="ms", ylim=(len(types) - 0.5, -0.5), xlim=(0, None))
    _framed(axes)
    axes.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)


def _framed(axes: Any) -> None:
    axes.grid(visible=True, color=LIGHT, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _short(name: str) -> str:
    """Return a name as plots can have it; a dollar would be taken for mathematics."""
    plain = name.replace("$", "")
    return plain if len(plain) <= 22 else f"{plain[:21]}…"
