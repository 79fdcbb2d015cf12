"""Policies to compare, in one interface: `policy(window) -> bool` decides the current message of a window.

Some remember what they did: every mission gets a policy of its own. A `Contender` names one and makes it afresh.
"""

from studies.policies.age import by_age
from studies.policies.contender import Contender
from studies.policies.fixed_rate import FixedRate, filling_interval
from studies.policies.planned import Planned
from studies.policies.receding import Receding
from studies.policies.simple import RandomSends, by_rank, send_all, whenever_it_fits

__all__ = [
    "Contender",
    "FixedRate",
    "Planned",
    "RandomSends",
    "Receding",
    "by_age",
    "by_rank",
    "filling_interval",
    "send_all",
    "whenever_it_fits",
]
