"""Who is there and which pairs are linked."""

from studies.demo.layout import OPERATOR, lay_out, pairs


def test_every_pair_is_linked_once_and_the_higher_number_dials():
    """A full mesh without double links."""
    nodes = lay_out(3)
    assert [node.name for node in nodes] == [OPERATOR, "r1", "r2", "r3"]
    linked = [(dialer.number, target.number) for dialer, target in pairs(nodes)]
    assert sorted(linked) == [(1, 0), (2, 0), (2, 1), (3, 0), (3, 1), (3, 2)]


def test_ports_are_different():
    """Nobody listens where another does."""
    ports = [port for node in lay_out(4) for port in (node.app_port, node.mesh_port)]
    assert len(set(ports)) == 10
