"""Much more than a daemon can take in, of everything that others may send to it."""

import json
import secrets

import pytest
import zenoh

from proxy.bridge import keys
from proxy.core.protocol.messages import tag
from tests.faults.strangers import Busy, Puppet
from tests.waiting import wait_until

pytestmark = pytest.mark.full


class Flood(Busy):
    """A robot says one kind of thing as fast as it can; `kind` names it."""

    def __init__(self, puppet, kind):
        super().__init__()
        self._puppet = puppet
        self._kind = kind
        self._held = []

    def act(self, number):
        getattr(self, f"_{self._kind}")(number)

    def _digests(self, number):
        self._puppet.tell(messages=number)

    def _states(self, _):
        self._puppet.tell_state("camera/flood")

    def _noise(self, number):
        key = keys.digest(f"nobody{number % 97}", f"{number % 9973:08x}")
        self._puppet.session.put(key, secrets.token_bytes(64))

    def _tokens(self, number):
        held = self._puppet.session.liveliness().declare_token(keys.alive(f"r{number % 500}", f"{number % 2000:x}0"))
        self._held.append(held)
        if len(self._held) > 400:
            self._held.pop(0).undeclare()

    def _questions(self, _):
        self._puppet.session.get(keys.ALL_STATES, zenoh.handlers.Callback(lambda _: None), timeout=0.1)

    def _subscriptions(self, number):
        if len(self._held) < 20_000:
            self._held.append(self._puppet.session.declare_subscriber(f"flood/{number}", lambda _: None))

    def _orders(self, _):
        key = keys.fleet("*", "mode")
        self._puppet.session.get(key, zenoh.handlers.Callback(lambda _: None), payload="shadow", timeout=0.1)


@pytest.mark.parametrize("kind", ["digests", "states", "noise", "tokens", "questions", "subscriptions", "orders"])
def test_a_flood_drowns_nobody(play, stack, kind):
    """Samples cross meanwhile, local ones too; what is too much is counted; afterwards all is as before."""
    scene = play(options=("--fleet.mode", "true", "--fleet.token", secrets.token_hex(16)))
    puppet = Puppet("flood", scene.first.mesh)
    stack.callback(puppet.close)
    wait_until(lambda: "flood" in scene.first.peers(), what="who floods")
    listeners = [scene.local, *scene.remote]
    with Flood(puppet, kind):
        for _ in range(3):
            scene.go_on(listeners=listeners)
            scene.first.status()
    puppet.close()
    scene.meet(60.0)
    scene.go_on()
    status = scene.first.status()
    print(kind, json.dumps(status["refused"]), json.dumps(status["daemon"]["floods"]))
    assert status["mode"] == "enforce"
    assert tag(puppet.zid) not in json.dumps(status["peers"])
    scene.finish()
