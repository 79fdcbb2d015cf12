"""How who asks a daemon proves to be an application of its robot, where `app.zenoh` has it take a proof.

Applications have a certificate, or a user and a password, in a configuration of Zenoh, which `ZENOH_CONFIG` names where
Zenoh's own programs and bindings look for it. Nothing else in it concerns us: where the daemon is our flags say.
"""

import json
import os
from collections.abc import Mapping
from typing import Any

import zenoh

from proxy.bridge.sessions import reason_of

VARIABLE = "ZENOH_CONFIG"
_TLS, _AUTH = "transport/link/tls", "transport/auth"

Credentials = dict[str, str]
"""What is set in the configuration of a session, as JSON by path."""


def of_options(options: Mapping[str, Any]) -> Credentials:
    """Return what a Zenoh configuration such as `app.zenoh` has."""
    transport = options.get("transport", {})
    found = {_TLS: transport.get("link", {}).get("tls"), _AUTH: transport.get("auth")}
    return {path: json.dumps(table) for path, table in found.items() if table}


def of_environment() -> tuple[Credentials, str]:
    """Return what the file has that the variable names, or why it has none that can be read."""
    if not (file := os.environ.get(VARIABLE)):
        return {}, ""
    try:
        config = zenoh.Config.from_file(file)
    except zenoh.ZError as error:
        return {}, f"{VARIABLE}: {file}: {reason_of(error)}"
    return {path: config.get_json(path) for path in (_TLS, _AUTH)}, ""
