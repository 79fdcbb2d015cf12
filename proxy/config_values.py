"""The syntax of single configuration values: robot names, endpoints, interfaces, key expressions."""

import ipaddress
import re
import socket
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field

from proxy.fleet_token import token_of
from utility_specs.suggestions import described, hint, quoted

FORBIDDEN = "/*$#?"
"""Characters that no chunk of a key may hold."""
LONGEST_NAME = 120
"""Letters of a robot's name: other robots take up to `BOUNDS.name_length`, and five come behind one that is taken."""

HOST_AND_PORT = re.compile(r"(?P<host>\[[0-9A-Fa-f:.%\w]+\]|[^\[\]:\s]+):(?P<port>\d+)")
SCOUTING = {"224.0.0.224:7446": "Zenoh", "224.0.0.225:7448": "Sendworthy"}
"""Groups on which robots are found."""
SECURED = ("tls", "quic")
"""Protocols by which robots know who speaks."""
ON_HOSTS = ("tcp", "udp", *SECURED, "ws")
ELSEWHERE = ("unixsock-stream", "unixpipe", "vsock", "serial")


def robot_name(name: str) -> str:
    """Return `name` if it is one valid key chunk that other robots take; ValueError otherwise."""
    if not name:
        raise ValueError("must not be empty")
    if name.startswith("@"):
        raise ValueError(f'must not start with "@": {quoted(name)}')
    bad = sorted({c for c in name if c in FORBIDDEN or c.isspace() or not c.isprintable()})
    if bad:
        shown = " ".join(c if c.isprintable() and not c.isspace() else repr(c) for c in bad)
        raise ValueError(f"must be one chunk of a key, without {shown}: {quoted(name)}")
    if len(name) > LONGEST_NAME:
        raise ValueError(f"must have at most {LONGEST_NAME} letters, not {len(name)}: {quoted(name)}")
    return name


def robot_of_host(host: str) -> str:
    """Make a valid robot name of a host name: what a key chunk cannot hold becomes a dash."""
    chunk = "".join("-" if c in FORBIDDEN or c.isspace() or not c.isprintable() else c for c in host)
    return chunk.lstrip("@")[:LONGEST_NAME] or "robot"


def this_robot() -> str:
    """Name the robot after the host that this process runs on."""
    return robot_of_host(socket.gethostname())


def endpoint(text: str) -> str:
    """Return `text` if it is an endpoint as Zenoh writes them; ValueError otherwise."""
    wrong = f'must be an endpoint like "tcp/192.168.1.2:7500", not {quoted(text)}'
    protocol, slash, rest = text.partition("/")
    address = re.split("[?#]", rest, maxsplit=1)[0]
    if not slash or not address:
        raise ValueError(wrong)
    if protocol not in ON_HOSTS + ELSEWHERE:
        raise ValueError(f"{wrong}: unknown protocol {quoted(protocol)}{hint(protocol, ON_HOSTS + ELSEWHERE)}")
    if protocol in ELSEWHERE:
        return text
    found = HOST_AND_PORT.fullmatch(address)
    if found is None:
        raise ValueError(f"{wrong}: the address must be HOST:PORT or [IPv6]:PORT")
    if int(found["port"]) > 65535:
        raise ValueError(f"{wrong}: a port is at most 65535")
    return text


def remote_endpoint(text: str) -> str:
    """Return `text` if it is an endpoint that can be dialled; ValueError otherwise."""
    found = HOST_AND_PORT.fullmatch(re.split("[?#]", endpoint(text).partition("/")[2], maxsplit=1)[0])
    if found is not None and int(found["port"]) == 0:
        raise ValueError(f"port 0 cannot be dialled: {quoted(text)}")
    return text


def interface(text: str) -> str:
    """Return `text` if it can name a network interface: "auto", a name, an address; else ValueError."""
    if not text or any(c in " /" or not c.isprintable() for c in text):
        raise ValueError(f'must be "auto" or an interface like "wlan0", not {quoted(text)}')
    return text


def multicast_group(text: str) -> str:
    """Return `text` if it is a multicast group and a port; ValueError otherwise."""
    wrong = f'must be a multicast group and a port like "224.0.0.226:7449" or "[ff02::226]:7449", not {quoted(text)}'
    found = HOST_AND_PORT.fullmatch(text)
    if found is None:
        raise ValueError(wrong)
    try:
        address = ipaddress.ip_address(found["host"].strip("[]"))
    except ValueError:
        raise ValueError(wrong) from None
    if not address.is_multicast or not 0 < int(found["port"]) <= 65535:
        raise ValueError(wrong)
    if text in SCOUTING:
        raise ValueError(f"{text} is where {SCOUTING[text]} finds others; take another one")
    return text


def http_address(text: str) -> str:
    """Return `text` if a server of HTTP can listen there, or if it is empty; ValueError otherwise."""
    found = HOST_AND_PORT.fullmatch(text)
    if text and (found is None or not 0 < int(found["port"]) <= 65535):
        raise ValueError(f'must be a host and a port like "127.0.0.1:9447" or "[::1]:9447", not {quoted(text)}')
    return text


def key_expression(text: str) -> str:
    """Return `text` if it is a key expression of Zenoh; ValueError otherwise."""
    import zenoh  # noqa: PLC0415 - few configurations need it

    try:
        return str(zenoh.KeyExpr(text))
    except UnicodeEncodeError:
        raise ValueError(f"must be a key expression, not {quoted(text)}: it is not UTF-8") from None
    except zenoh.ZError as error:
        # Zenoh repeats the text first and ends with a place in its own source.
        cause = str(error).split("`: ", maxsplit=1)[-1].split(" at /")[0]
        ros = f'; the ROS 2 topic {text} has keys like "*{text}/**"' if text.startswith("/") else ""
        raise ValueError(f"must be a key expression, not {quoted(text)}: {cause}{ros}") from None


def fleet_token(text: str) -> str:
    """Return `text` without blanks around it if it can be a token, or if it is empty; ValueError otherwise."""
    return token_of(text) if text else text


def path_text(value: object) -> object:
    """Return `value` if it can be a path; ValueError otherwise, in the words of the other settings."""
    if not isinstance(value, str | Path):
        raise ValueError(f"must be a string, not {described(value)}")  # noqa: TRY004 - pydantic wants ValueError
    if "\0" in str(value):
        raise ValueError("must be a path, which holds no zero byte")
    return value


RobotName = Annotated[str, AfterValidator(robot_name)]
ListenEndpoints = Annotated[tuple[Annotated[str, AfterValidator(endpoint)], ...], Field(strict=False)]
RemoteEndpoints = Annotated[tuple[Annotated[str, AfterValidator(remote_endpoint)], ...], Field(strict=False)]
SpecsPath = Annotated[Path, Field(strict=False), BeforeValidator(path_text)]
MulticastGroup = Annotated[str, AfterValidator(multicast_group)]
FleetToken = Annotated[str, AfterValidator(fleet_token)]
HttpAddress = Annotated[str, AfterValidator(http_address)]
Interface = Annotated[str, AfterValidator(interface)]
KeyExpressions = Annotated[tuple[Annotated[str, AfterValidator(key_expression)], ...], Field(strict=False)]
