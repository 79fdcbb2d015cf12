"""Whether the certificates of TLS hold: a daemon without them does not start, or gets no link and never learns why."""

import ssl
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from proxy import clock
from proxy.bridge.identities import certified_names
from proxy.config import Config
from proxy.config_values import SECURED
from proxy.doctor.finding import Finding, finding, fine, unknown

SOON = 30 * 86400.0
"""Whoever is to renew a certificate is told so long before it ends [s]."""
_ENDS = ("listen", "connect")
_FLIGHTS = 4
"""After so many times that both ends speak, a handshake is over."""
_RENEW = "have your authority make another one"


def certificates(config: Config) -> Iterator[Finding]:
    """Look at those of both sides as another robot or application would."""
    sides = (("app", config.app.zenoh, config.app.listen), ("mesh", config.mesh.zenoh, config.mesh.listens))
    for side, options, listen in sides:
        tls = options.get("transport", {}).get("link", {}).get("tls") or {}
        yield from _missing(f"{side}.zenoh.transport.link.tls", tls, listen)
        names = certified_names(options) if side == "mesh" else frozenset()
        pairs = {end: _Pair.of(tls, end) for end in _ENDS}
        for end, pair in pairs.items():
            if pair is not None and (end == "listen" or pair != pairs["listen"]):
                label = f"{side}.zenoh.transport.link.tls.{end}_certificate: {pair.certificate}"
                yield _looked_at(pair, label, config.robot if names else "", listens=end == "listen")


def _missing(label: str, tls: Mapping[str, Any], listen: Iterable[str]) -> Iterator[Finding]:
    """Name what nobody can listen without at an endpoint; one may have its own behind "#"."""
    secured = [each for each in listen if each.partition("/")[0] in SECURED and "#" not in each]
    for what in ("certificate", "private_key"):
        if secured and not any(tls.get(f"listen_{what}{form}") for form in ("", "_base64")):
            yield finding("certificates", f"{label}.listen_{what}: is missing, and {secured[0]} takes one: set it")


@dataclass(frozen=True, slots=True)
class _Pair:
    """The files of a certificate, of its key, and of the authority that others have, too; None: the host's."""

    certificate: str
    key: str
    authority: str | None

    @classmethod
    def of(cls, tls: Mapping[str, Any], end: str) -> "_Pair | None":
        """Return that of one end of links; None where there is none, or not in files."""
        certificate, key = tls.get(f"{end}_certificate"), tls.get(f"{end}_private_key")
        known = isinstance(certificate, str) and isinstance(key, str)
        return cls(certificate, key, tls.get("root_ca_certificate")) if known else None  # type: ignore[arg-type]


def _looked_at(pair: _Pair, label: str, robot: str, *, listens: bool) -> Finding:
    """Look at one; with access control its name is to be that of the `robot`."""
    try:
        shown = _shown(pair, listens=listens)
    except PermissionError:
        return unknown("certificates", f"{label}: it or its key may not be read: run it with sudo")
    except ssl.SSLCertVerificationError as error:
        return finding("certificates", f"{label}: others refuse it: {error.verify_message}: {_RENEW}")
    except ssl.SSLError as error:
        other = error.reason == "KEY_VALUES_MISMATCH"
        said = f"{pair.key} is the key of another one" if other else "it, its key or the authority's is no PEM"
        return finding("certificates", f"{label}: {said}: correct it")
    except OSError as error:
        return finding("certificates", f"{label}: {error.strerror}: correct it")
    return _held(shown, label, robot)


def _held(shown: Mapping[str, Any], label: str, robot: str) -> Finding:
    """Say for how long and for whom one holds that others take."""
    ends = ssl.cert_time_to_seconds(shown["notAfter"])
    until = time.strftime("%Y-%m-%d", time.gmtime(ends))
    name = next((text for part in shown["subject"] for key, text in part if key == "commonName"), "")
    if robot and name != robot:
        text = f'its name is "{name}", so access control takes nothing that robot {robot} says of itself: {_RENEW}'
        return finding("certificates", f"{label}: {text}")
    if ends - clock.wall() < SOON:
        return finding("certificates", f"{label}: it ends on {until}, and links with it: {_RENEW}")
    return fine("certificates", f"{label}: holds until {until}")


def _shown(pair: _Pair, *, listens: bool) -> dict[str, Any]:
    """Show a certificate to one who knows the authority; return what that one sees. Raises OSError."""
    ends = [ssl.SSLContext(protocol) for protocol in (ssl.PROTOCOL_TLS_SERVER, ssl.PROTOCOL_TLS_CLIENT)]
    other = ends[listens]
    ends[1].check_hostname = False  # nobody knows by which address it will be dialled
    ends[1].verify_mode = ssl.CERT_NONE
    for context in ends:
        context.load_cert_chain(pair.certificate, pair.key, password="")  # a locked one no daemon can read either
    other.verify_mode = ssl.CERT_REQUIRED
    if pair.authority is None:
        other.load_default_certs(ssl.Purpose.SERVER_AUTH)
    else:
        other.load_verify_locations(pair.authority)
    there, back = ssl.MemoryBIO(), ssl.MemoryBIO()
    server = ends[0].wrap_bio(there, back, server_side=True)
    client = ends[1].wrap_bio(back, there)
    for _ in range(_FLIGHTS):
        for end in (client, server):
            with suppress(ssl.SSLWantReadError):
                end.do_handshake()
    return (client if listens else server).getpeercert() or {}
