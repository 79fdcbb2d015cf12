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
