"""Programs on the mesh that say what daemons say: any robot, as far as others can tell."""

import threading
import time
from contextlib import suppress

import zenoh

from proxy.bridge import keys
from proxy.core.protocol.digest_codec import pack_digest
from proxy.core.protocol.messages import Digest, State, StreamDigest, StreamState, tag
from proxy.core.protocol.state_codec import pack_state
from tests.faults.scene import Fault
from tests.proxy.nodes import plain_session


class Puppet:
    """Looks like a robot `name` to the daemon at `mesh`."""

    def __init__(self, name, *meshes):
        self.name = name
        self.session = plain_session("peer", connect=meshes)
        self.zid = str(self.session.zid())
        self._began = time.monotonic()
        self._token = self.session.liveliness().declare_token(keys.alive(name, self.zid))

    def tell_state(self, key=""):
        """Say that it has a stream, if there is a key."""
        streams = (StreamState(1, key, "camera", 0.1, 0.0, 1000),) if key else ()
        state = State(self.name, self.zid, "enforce", "", streams, (), number=1)
        self.session.put(keys.state(self.name, tag(self.zid)), pack_state(state))

    def tell(self, *, messages=0, size=0, generated=0, scale=1.0, **parts):
        """Say that it has sent so many messages of its stream, of so many bytes each; and what digests say of `parts`.

        More may have been `generated`.
        """
        sent, count = time.monotonic() - self._began, max(messages, generated)
        news = (StreamDigest(1, count, messages, sent, sent if messages else 0.0, size, scale),) if count else ()
        digest = Digest(self.name, tag(self.zid), sent, messages, messages * size, news, state=1, **parts)
        self.session.put(keys.digest(self.name, tag(self.zid)), pack_digest(digest))

    def close(self):
        self.session.close()


class Busy(Fault):
    """Does something over and over on a thread of its own, until it is over."""

    def __init__(self):
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self):
        self._thread.start()

    def stop(self):
        self._over.set()
        self._thread.join()

    def act(self, number):
        """Do it for the time with that number."""
        raise NotImplementedError

    def _run(self):
        number = 0
        with suppress(zenoh.ZError):  # the session is closed
            while not self._over.wait(self.pause):
                self.act(number)
                number += 1

    pause = 0.0
