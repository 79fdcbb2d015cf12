"""Who is there and where each listens: the operator and the robots, and which pairs of them are linked."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import combinations

OPERATOR = "operator"


@dataclass(frozen=True, slots=True)
class Node:
    """A robot or the operator: its number, its port for apps and its port for the others."""

    number: int
    name: str
    app_port: int
    mesh_port: int

    @property
    def app_endpoint(self) -> str:
        """Where its apps connect."""
        return f"tcp/127.0.0.1:{self.app_port}"

    @property
    def mesh_endpoint(self) -> str:
        """Where the medium reaches it."""
        return f"tcp/127.0.0.1:{self.mesh_port}"


def lay_out(robots: int) -> tuple[Node, ...]:
    """Give the operator, number 0, and the robots free ports."""
    names = [OPERATOR, *(f"r{number}" for number in range(1, robots + 1))]
    ports = iter(free_ports(2 * len(names)))
    return tuple(Node(number, name, next(ports), next(ports)) for number, name in enumerate(names))


def pairs(nodes: tuple[Node, ...]) -> Iterator[tuple[Node, Node]]:
    """Yield each pair once, the one that dials, the higher-numbered, first."""
    for low, high in combinations(nodes, 2):
        yield high, low


def free_ports(count: int) -> list[int]:
    """Return ports of localhost that nobody listens at now."""
    with ExitStack() as held:
        sockets = [held.enter_context(socket.socket()) for _ in range(count)]
        for sock in sockets:
            sock.bind(("127.0.0.1", 0))
        return [int(sock.getsockname()[1]) for sock in sockets]
