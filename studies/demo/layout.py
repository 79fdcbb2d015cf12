"""Who is there and where each listens: the operator and the robots, and which pairs of them are linked."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from studies.demo.ports import free_ports

OPERATOR = "operator"


@dataclass(frozen=True, slots=True)
class Node:
    """A robot or the operator: its number, its port for apps and its port for the others.

    The others find it at `host`. A node of its own network `namespace` shares localhost with its apps only.
    """

    number: int
    name: str
    app_port: int
    mesh_port: int
    host: str = "127.0.0.1"
    namespace: str | None = None

    @property
    def app_endpoint(self) -> str:
        """Where its apps connect."""
        return f"tcp/127.0.0.1:{self.app_port}"

    @property
    def mesh_endpoint(self) -> str:
        """Where the medium reaches it."""
        return f"tcp/{self.host}:{self.mesh_port}"


def lay_out(robots: int) -> tuple[Node, ...]:
    """Give the operator, number 0, and the robots free ports."""
    (nodes,) = lay_out_teams(robots, 1)
    return nodes


def lay_out_teams(robots: int, teams: int) -> list[tuple[Node, ...]]:
    """Give each team's operator, number 0, and robots free ports; so many teams can be there at a time."""
    names = [OPERATOR, *(f"r{number}" for number in range(1, robots + 1))]
    ports = iter(free_ports(2 * len(names) * teams))
    return [
        tuple(Node(number, name, next(ports), next(ports)) for number, name in enumerate(names)) for _ in range(teams)
    ]


def pairs(nodes: tuple[Node, ...]) -> Iterator[tuple[Node, Node]]:
    """Yield each pair once, the one that dials, the higher-numbered, first."""
    for low, high in combinations(nodes, 2):
        yield high, low
