"""How a query was asked, from the numbers on the wire."""

import zenoh

from proxy.bridge.declarations.query_options import QueryOptions, options_of
from proxy.bridge.declarations.tuning import TUNING
from proxy.bridge.declarations.wire import Asked

DROP, BLOCK = zenoh.CongestionControl.DROP, zenoh.CongestionControl.BLOCK


def asked(*, target, timeout, qos):
    return Asked(0, "a", senders=False, parameters="", target=target, timeout=timeout, qos=qos)


def test_numbers_of_the_wire_become_words_of_the_interface():
    """Priority in the lowest three bits, then whether it waits for room, then whether it is express."""
    assert options_of(asked(target=2, timeout=3.0, qos=0x1C)) == QueryOptions(
        zenoh.QueryTarget.ALL_COMPLETE, 3.0, zenoh.Priority.DATA_HIGH, BLOCK, express=True
    )
    assert options_of(asked(target=0, timeout=None, qos=0x05)) == QueryOptions(
        zenoh.QueryTarget.BEST_MATCHING, TUNING.default_query_timeout, zenoh.Priority.DATA, DROP, express=False
    )


def test_only_a_query_for_all_complete_ones_reaches_only_those():
    """Of what is not known everybody is asked."""
    found = [options_of(asked(target=target, timeout=None, qos=0)).complete for target in range(4)]
    assert found == [False, False, True, False]
    unknown = options_of(None)
    assert (unknown.complete, unknown.target) == (False, zenoh.QueryTarget.ALL)
    assert options_of(asked(target=3, timeout=None, qos=0)).target == zenoh.QueryTarget.ALL
