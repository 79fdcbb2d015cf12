"""What records of flights have in common, whatever mission was flown."""

from collections.abc import Sequence
from statistics import fmean, median

import numpy as np

from studies.simulation.records import Delivery
from studies.study.store import Record

LATE = 0.95
"""The quantile of delays and decision times that is kept beside the median."""


def quantiles(values: Sequence[float]) -> list[float]:
    """Return the median and a late one, or nothing of none."""
    return [round(median(values), 7), round(float(np.quantile(values, LATE)), 7)] if values else []


def channel(due: Sequence[Delivery], offered: float) -> Record:
    """Return which part of copies arrived and how late [s], and what all offered [B/s]: so saturation is seen."""
    delays = [d.t_rcv - d.t_sent for d in due if d.t_rcv is not None]
    arrived = fmean(d.t_rcv is not None for d in due) if due else 1.0
    return {"arrived": arrived, "delay": quantiles(delays), "offered": offered}


def offline(utility: float, maximum: float, generated: int, sent: float) -> Record:
    """Return the record of who knows everything, and loses nothing."""
    return {
        "utility": utility,
        "maximum": maximum,
        "generated": generated,
        "sent": sent,
        "received": sent,
        "over": 0.0,
        "worst": 1.0,
        "told": 0.0,
        "decision": [],
        "network": {},
    }
