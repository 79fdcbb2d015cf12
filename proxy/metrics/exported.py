"""All metrics, by topic. Names and units by the conventions of Prometheus: base units, counters of what only grows.

Their labels have few values: information types, constraints and features of the specs, reasons, robots of the team.
"""

from collections.abc import Iterator
from functools import partial

from proxy.core.model.mode import Mode
from proxy.metrics.metric import Metric, Row, Status, by_name, each_of, entry, single
from proxy.metrics.peers import PEERS

DROPPED = "dropped:"
UNITS = {"B": "bytes", "messages": "messages", "s": "seconds", "J": "joules"}
"""What limits count, as metrics are called."""


def _modes(status: Status) -> Iterator[Row]:
    for mode in Mode:
        yield (mode.value,), float(status["mode"] == mode.value)


def _shortcuts(status: Status) -> Iterator[Row]:
    for kind in ("unneeded", "certain", "undisputed", "hopeless", "would_drop", "owed", "unkept", "late"):
        yield (kind,), status["decisions"][kind]


def _generated(name: str, status: Status) -> Iterator[Row]:
    for kind, of_type in status["types"].items():
        yield (kind,), of_type[name]


def _decided(status: Status) -> Iterator[Row]:
    for kind, of_type in status["types"].items():
        for reason, count in of_type["by_reason"].items():
            yield (kind, reason), count


def _amounts(amount: str, unit: str, status: Status) -> Iterator[Row]:
    for limit in status["budget"]:
        if limit["unit"] == unit:
            yield (limit["constraint"],), limit[amount]


def _used(limit: Status) -> float:
    return float(limit["used"] / limit["limit"]) if limit["limit"] else 0.0


def _price(limit: Status) -> float:
    return float(limit["price_per_kb"] / 1000)


def _adaptive(name: str, limit: Status) -> float | None:
    return limit["adaptive"][name] if "adaptive" in limit else None


def _waiting(unit: str, status: Status) -> Iterator[Row]:
    for kind in ("covered", "passing"):
        yield (kind,), status["daemon"]["queue"][kind][unit]


def _denied(status: Status) -> Iterator[Row]:
    for way, kinds in status["daemon"]["denied"].items():
        for kind, count in kinds.items():
            yield (way, kind), count


def _of_features(name: str, status: Status) -> Iterator[Row]:
    return each_of(("features",), ("type", "feature"), partial(entry, name))(status)


ABOUT = (
    Metric(
        "build_info",
        "gauge",
        "1; the version of Sendworthy, and that of what daemons tell each other.",
        lambda status: [((status["version"], str(status["wire_version"])), 1.0)],
        ("version", "wire_version"),
    ),
    Metric(
        "specs_info",
        "gauge",
        "1; the generation of the utility specs in force.",
        lambda status: [((status["specs"],), 1.0)],
        ("generation",),
    ),
    Metric("mode", "gauge", "1 for the mode in force, 0 for the others.", _modes, ("mode",)),
    Metric("uptime_seconds", "gauge", "Time since the daemon started.", single("uptime")),
    Metric(
        "warnings",
        "gauge",
        "What is wrong now: the lines that `sendworthy status` warns with.",
        lambda status: [((), float(len(status["warnings"])))],
    ),
    Metric("reloads", "counter", "Reloads of specs and configuration.", single("daemon", "reloads", "done")),
    Metric(
        "reloads_refused",
        "counter",
        "Reloads that changed nothing for a mistake in the files.",
        single("daemon", "reloads", "refused"),
    ),
    Metric("faults", "counter", "Internal errors; the log has each.", single("daemon", "faults")),
)

SAMPLES = (
    Metric(
        "samples_received",
        "counter",
        "Samples of this robot's applications that somebody on another robot wants.",
        single("counts", "in"),
    ),
    Metric(
        "samples_forwarded",
        "counter",
        "Samples that were handed to the mesh, by why.",
        by_name("counts", "by_reason", without=DROPPED),
        ("reason",),
    ),
    Metric(
        "samples_dropped",
        "counter",
        "Samples that were dropped, by why.",
        by_name("counts", "by_reason", only=DROPPED),
        ("reason",),
    ),
    Metric(
        "samples_passed_bytes",
        "counter",
        "What samples that passed without a decision took on the air, by why they passed.",
        by_name("counts", "bytes"),
        ("reason",),
    ),
    Metric("samples_queued", "gauge", "Samples that wait to be decided or handed over.", single("counts", "queued")),
    Metric(
        "samples_delivered",
        "counter",
        "Samples of other robots that were handed to this robot's applications.",
        single("daemon", "delivered"),
    ),
    Metric(
        "type_samples_generated",
        "counter",
        "Samples of this robot that an information type covers.",
        partial(_generated, "generated"),
        ("type",),
    ),
    Metric(
        "type_samples_decided",
        "counter",
        "What was decided on them, by reason; in mode shadow they went all the same.",
        _decided,
        ("type", "reason"),
    ),
    Metric(
        "type_streams",
        "gauge",
        "Streams of this robot that an information type covers now.",
        partial(_generated, "streams"),
        ("type",),
    ),
    Metric(
        "kept_copies",
        "counter",
        "Copies for robots that were away, by what became of them.",
        by_name("kept", "by_reason"),
        ("reason",),
    ),
    Metric("kept_copies_waiting", "gauge", "Copies that wait for robots that are away.", single("kept", "waiting")),
    Metric("kept_bytes", "gauge", "What they take in memory.", single("kept", "bytes")),
)

CHANNEL = (
    Metric(
        "sent_messages",
        "counter",
        "Messages that this robot put on the air: one for each copy of a sample.",
        single("on_air", "messages"),
    ),
    Metric("sent_bytes", "counter", "Payload bytes of these messages.", single("on_air", "bytes")),
    *(
        Metric(f"channel_{amount}_{unit}", "gauge", text, partial(_amounts, amount, symbol), ("constraint",))
        for amount, text in (
            (
                "limit",
                "What robots may use together within a window of the constraint, without what is left to digests.",
            ),
            ("held", "What of the limit is this robot's to use now."),
            ("used", "What this robot counts as used within the window that ends now."),
        )
        for symbol, unit in UNITS.items()
    ),
    Metric(
        "channel_used_ratio",
        "gauge",
        "What is used, of the limit; above 1 a window holds more than it may.",
        each_of(("budget",), ("constraint",), _used),
        ("constraint",),
    ),
    Metric(
        "channel_window_seconds",
        "gauge",
        "How long a window of the constraint is.",
        each_of(("budget",), ("constraint",), partial(entry, "window")),
        ("constraint",),
    ),
    Metric(
        "channel_adaptive_ratio",
        "gauge",
        "What is in force of the ceiling of a limit that follows the channel.",
        each_of(("budget",), ("constraint",), partial(_adaptive, "in_force")),
        ("constraint",),
    ),
    Metric(
        "channel_queue_delay_seconds",
        "gauge",
        "By how much a queue in the channel delays messages, where a limit follows the channel.",
        each_of(("budget",), ("constraint",), partial(_adaptive, "delay")),
        ("constraint",),
    ),
    Metric(
        "channel_price_per_byte",
        "gauge",
        "What another byte in one copy costs now [utility times seconds]: what the best plan loses for it elsewhere.",
        each_of(("budget",), ("constraint",), _price),
        ("constraint",),
    ),
    Metric(
        "channel_scarce_drops",
        "counter",
        "Drops because of a constraint that had no room.",
        by_name("decisions", "binding"),
        ("constraint",),
    ),
)

DECISIONS = (
    Metric("decisions", "counter", "Searches that decided on a sample.", single("decisions", "made")),
    Metric("decision_seconds", "counter", "Time that they took.", single("decisions", "seconds")),
    Metric("decision_longest_seconds", "gauge", "The longest of them.", single("decisions", "longest")),
    Metric("decision_iterations", "counter", "Iterations that they did.", single("decisions", "iterations")),
    Metric("decisions_proven", "counter", "Decisions that no plan betters.", single("decisions", "proven")),
    Metric(
        "decision_shortcuts",
        "counter",
        "Samples that were decided on without a search, or in another way than it said; `late`: no answer in time.",
        _shortcuts,
        ("kind",),
    ),
    Metric(
        "decision_utility",
        "counter",
        "What the plans of all decisions are worth [utility times seconds].",
        single("decisions", "utility"),
    ),
    Metric(
        "decision_gap",
        "counter",
        "By how much the best plans may be worth more at most [utility times seconds].",
        single("decisions", "gap"),
    ),
    Metric(
        "decision_windows_thinned",
        "counter",
        "Windows that held fewer messages, to be decided in time.",
        single("decisions", "thinned", "windows"),
    ),
)

QUEUES = (
    Metric("queue_samples", "gauge", "Samples that wait on their way out.", partial(_waiting, "samples"), ("kind",)),
    Metric("queue_bytes", "gauge", "Bytes of these samples.", partial(_waiting, "bytes"), ("kind",)),
    Metric(
        "queue_limit_samples",
        "gauge",
        "How many samples of each kind may wait.",
        single("daemon", "queue", "most", "samples"),
    ),
    Metric(
        "queue_limit_bytes",
        "gauge",
        "How many bytes of each kind may wait.",
        single("daemon", "queue", "most", "bytes"),
    ),
    Metric("core_waiting_items", "gauge", "Events that wait for the core.", single("daemon", "waiting")),
    Metric(
        "core_refused_items",
        "counter",
        "Messages of other robots that came faster than the core takes them in.",
        single("daemon", "refused"),
    ),
    Metric(
        "bridge_denied",
        "counter",
        "What the rules of [bridge] kept from crossing.",
        _denied,
        ("direction", "kind"),
    ),
    Metric(
        "feature_failures",
        "counter",
        "Samples of which a feature could not be computed.",
        partial(_of_features, "failed"),
        ("type", "feature"),
    ),
    Metric(
        "feature_held",
        "counter",
        "Samples for which an older value of a costly feature stood.",
        partial(_of_features, "held"),
        ("type", "feature"),
    ),
    Metric(
        "feature_cost_seconds",
        "gauge",
        "What it takes to compute a feature that has a budget.",
        partial(_of_features, "cost"),
        ("type", "feature"),
    ),
)

METRICS = (*ABOUT, *SAMPLES, *CHANNEL, *DECISIONS, *QUEUES, *PEERS)
