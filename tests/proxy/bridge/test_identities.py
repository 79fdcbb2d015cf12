"""Which names certificates vouch for; `tests/docs/test_security.py` has links with certificates."""

from proxy.access import access_control
from proxy.bridge.identities import Identities, certified_names
from tests.proxy.nodes import closing, free_endpoint, plain_session
from tests.waiting import wait_until


def test_access_control_names_who_has_a_certificate():
    """Where it is in force."""
    control = access_control(("r1", "r2"))
    assert certified_names({"access_control": control}) == {"r1", "r2"}
    assert certified_names({"access_control": control | {"enabled": False}}) == set()
    assert certified_names({"access_control": {"enabled": True}}) == certified_names({}) == set()


def test_a_link_without_a_certificate_says_nothing(stack):
    """Nobody vouches for who is there, nor for who has no link here."""
    endpoint = free_endpoint()
    here = closing(stack, plain_session("peer", listen=(endpoint,)))
    there = closing(stack, plain_session("peer", connect=(endpoint,)))
    identities = Identities(here, {"r1"})
    assert [identities.forged(name, str(there.zid())) for name in ("r1", "r2")] == [False, False]
    assert not identities.forged("r1", "0a")


def test_who_has_no_link_is_absent_unless_behind_a_router(stack):
    """Robots that are linked each to each hear of nobody else."""
    endpoint = free_endpoint()
    here = closing(stack, plain_session("peer", listen=(endpoint,)))
    there = closing(stack, plain_session("peer", connect=(endpoint,)))
    identities = Identities(here, ())
    wait_until(lambda: not identities.absent(str(there.zid())), what="the link")
    assert identities.absent("0a")
    wait_until(lambda: not identities.strange(str(there.zid())), what="news of the link")
    assert identities.strange("0a")
    router = closing(stack, plain_session("router", connect=(endpoint,)))
    wait_until(lambda: not identities.absent("0a"), what="the router")
    assert not identities.absent(str(router.zid()))
    wait_until(lambda: not identities.strange(str(router.zid())), what="news of the router")
    assert identities.strange("0a")
    zid = str(router.zid())
    router.close()
    wait_until(lambda: identities.strange(zid), what="news of its end")
