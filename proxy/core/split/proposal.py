"""Whether a bid that a robot may announce is worth an agreement: what all would have if they agreed on it."""

from proxy.core.protocol.bid import Bid, alike, alike_but_for_slots, few_parts
from proxy.core.split.agreement import Agreement
from proxy.core.split.tuning import TUNING


def worthwhile(agreement: Agreement, bid: Bid) -> bool:
    """Whether our bid should be this one from now on."""
    same = alike(agreement.bid[1], bid) or indifferent(agreement, bid)
    return not same or starves(agreement, bid)


def indifferent(agreement: Agreement, bid: Bid) -> bool:
    """Whether little would be gained if all agreed on this bid of ours, as far as we have everybody's.

    Either each would have about what it has, or slots alone would change hands, and all together gain little.
    """
    if (bids := _bids_with(agreement, bid)) is None:
        return False
    newest = agreement.log.newest
    had, allocation = newest.allocation, newest.allocated(bids)
    if allocation.resembles(had):
        return True
    slots = alike_but_for_slots(agreement.bid[1], bid) and all(map(few_parts, bids.values()))
    if not slots or allocation.largest(agreement.own) > TUNING.message_growth * had.largest(agreement.own):
        return False
    return allocation.worth(bids) < (1.0 + TUNING.slot_gain) * had.worth(bids)


def starves(agreement: Agreement, bid: Bid) -> bool:
    """Whether no message fits what we have, though one would with this bid (one of four robots was silent for 12 s)."""
    newest = agreement.log.newest
    if newest.allocation.carries(agreement.own, bid):
        return False
    bids = _bids_with(agreement, bid)
    return bids is not None and newest.allocated(bids).carries(agreement.own, bid)


def _bids_with(agreement: Agreement, bid: Bid) -> dict[str, Bid] | None:
    """Return everybody's bid and this one of ours, if we have all."""
    newest = agreement.log.newest
    bids = {tag: entry[1] for tag, entry in newest.entries.items() if entry is not None} | {agreement.own: bid}
    return bids if newest.complete and bids.keys() == agreement.members else None
