"""Who a certificate says is at the other end of a link, for robots that access control knows by their certificates.

Access control lets a robot show presence tokens of its own name alone, but not of its own session alone: one that shows
another one's session under its name would have all others take that one's digests for forged.
"""

from collections.abc import Collection, Mapping
from typing import Any

import zenoh

from proxy.bridge.sockets import links_of


class Identities:
    """Knows the links of `session`; `names` are those that certificates vouch for."""

    def __init__(self, session: zenoh.Session, names: Collection[str]) -> None:
        self._session = session
        self._names = frozenset(names)

    def forged(self, robot: str, zid: str) -> bool:
        """Whether a token says that the session `zid` is of `robot`, and the certificate of its link another name.

        A robot without a link of its own, behind a router, nobody vouches for.
        """
        name = robot.removesuffix(f"-{zid[:4]}")
        if name not in self._names:
            return False
        vouched = {link.auth_identifier for link in links_of(self._session) if str(link.zid) == zid} - {None}
        return bool(vouched) and name not in vouched


def certified_names(zenoh_options: Mapping[str, Any]) -> frozenset[str]:
    """Return the names of certificates that the access control of a session has rules for."""
    control = zenoh_options.get("access_control", {})
    if not control.get("enabled"):
        return frozenset()
    return frozenset(name for each in control.get("subjects") or () for name in each.get("cert_common_names") or ())
