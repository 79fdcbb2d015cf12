"""Robots that agree, without digests between them."""

from proxy.core.protocol.bid import Segment
from proxy.core.protocol.split_report import SplitReport
from proxy.core.split.agreement import Agreement

BID = (Segment(4000, 120),)


def robot(own, others="", version=0):
    agreement = Agreement(own, 0.0, floor=200, settled_at=1.0, kind=b"", version=version)
    agreement.set_members(0.0, set(others))
    agreement.ask(0.0, BID)
    return agreement


def tell(now, sender, *receivers):
    names = sender.log.newest.name, 0 if sender.newcomer else sender.log.agreed.name
    version, bid = sender.bid
    for receiver in receivers:
        receiver.heard(now, sender.own, SplitReport(version, bid, *names))
        receiver.settle(now)


def agree(now, *robots):
    for _ in range(3):
        for sender in robots:
            tell(now, sender, *[r for r in robots if r is not sender])
