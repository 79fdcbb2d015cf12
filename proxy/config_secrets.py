"""What of a configuration nobody is shown: passwords, tokens, private keys. Paths of files are no secret."""

import re
from collections.abc import Mapping
from typing import Any

from proxy.config_layers import KeyPath

HIDDEN = "(not shown)"
_NAME = r"(?:password|passphrase|secret|token|private_key_base64|private_key_pem)s?"
_KEY = re.compile(rf"(?:.*[_-])?{_NAME}", re.IGNORECASE)
"""How the keys are called that hold one."""
_WITHIN = re.compile(rf"((?:[#;?&]|^)(?:\w*[_-])?{_NAME}=)[^;&]*", re.IGNORECASE)
"""One within an endpoint: `tls/10.0.0.1:7500#listen_private_key_base64=…`."""
_PEM = "PRIVATE KEY-----"


def without_secrets(value: Any, path: KeyPath = ()) -> Any:
    """Return a value of the configuration, which `path` leads to, without the secrets in it."""
    names = [part for part in path if isinstance(part, str)]
    match value:
        case Mapping():
            return {key: without_secrets(inner, (*path, key)) for key, inner in value.items()}
        case list() | tuple():
            return [without_secrets(inner, path) for inner in value]
        case "" | bool() | None:
            return value
        case _ if any(map(_KEY.fullmatch, names)):
            return HIDDEN
        case str():
            return HIDDEN if _PEM in value else _WITHIN.sub(rf"\1{HIDDEN}", value)
        case _:
            return value
