"""Robots that have just come."""

import math

from proxy.core.model.settings import CoreSettings
from proxy.core.protocol.messages import Digest, State
from proxy.core.view.tuning import TUNING
from proxy.core.view.view import SharedView


def test_who_has_just_been_met_may_say_for_a_moment_what_it_sent_lately(make_specs):
    """Until it has, or that is over; who has no streams has nothing to say."""
    view = SharedView(CoreSettings("r1", "z-r1"), make_specs())
    assert view.newcomers.greeted_by(1.0) == -math.inf
    view.add_peer(1.0, "r2", "z-r2")
    view.add_peer(1.1, "r3", "z-r3")
    assert view.newcomers.greeted_by(1.1) == 1.1 + TUNING.greeting_time
    view.heard_state(1.1, State("r3", "z-r3", "enforce", ""))
    assert view.newcomers.greeted_by(1.1) == 1.0 + TUNING.greeting_time
    view.heard_digest(1.2, Digest("r2", "z-r2", 1.2))
    assert view.newcomers.greeted_by(1.2) == -math.inf
    view.add_peer(2.0, "r4", "z-r4")
    assert view.newcomers.greeted_by(2.0 + TUNING.greeting_time) == -math.inf
