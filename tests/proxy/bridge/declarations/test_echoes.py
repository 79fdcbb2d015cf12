"""A client is told its own tokens, too: they are left out."""

from proxy.bridge.declarations.echoes import Echoes
from proxy.bridge.declarations.tuning import TUNING


def test_our_own_tokens_are_left_out_and_for_a_moment_after_their_end():
    """Then a token of that name is somebody else's."""
    echoes, alive = Echoes(), {"ours": False, "theirs": False}
    assert echoes.without(alive, {"ours"}, 0.0) == {"theirs": False}
    assert not echoes.waiting({"ours"})
    assert echoes.waiting(())
    assert echoes.without(alive, (), TUNING.echo / 2) == {"theirs": False}
    assert echoes.without(alive, (), TUNING.echo) == alive
    assert not echoes.waiting(())


def test_of_a_name_that_was_somebody_elses_before_it_was_ours_it_stays():
    """Nobody tells a client whether a token of that name is somebody else's, too."""
    echoes, alive = Echoes(), {"both": False}
    assert echoes.without(alive, {"both"}, 0.0, kept={"both"}) == alive
    assert echoes.without({}, (), TUNING.echo, kept={"both"}) == {}


def test_the_ends_of_our_own_tokens_are_left_out():
    """Those that are ours, and those that were a moment ago."""
    echoes = Echoes()
    assert echoes.ended({"ours", "theirs"}, {"ours"}) == {"theirs"}
    echoes.without({}, {"ours"}, 0.0)
    assert echoes.ended({"ours", "theirs"}, ()) == {"theirs"}
    echoes.without({}, (), TUNING.echo)
    assert echoes.ended({"ours"}, ()) == {"ours"}
