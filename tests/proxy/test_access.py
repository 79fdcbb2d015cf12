"""The rules of access control, as they are made from names; `tests/docs/test_security.py` has robots live by them."""

import pytest

from proxy.access import access_control


def own(control, name):
    """The keys that a robot alone may speak on."""
    (rule,) = [rule for rule in control["rules"] if rule["id"] == f"what {name} says of itself"]
    return rule["key_exprs"]


def test_each_robot_speaks_for_itself():
    """Under its name, and under the one that it gets while another one has its name."""
    control = access_control(("r1", "r2"))
    assert (control["enabled"], control["default_permission"]) == (True, "deny")
    assert own(control, "r1") == [
        f"@sendworthy/{chunk}/{kind}/*" for chunk in ("r1", "r1-$*") for kind in ("alive", "state", "digest", "fleet")
    ]
    assert {"id": "r1", "cert_common_names": ["r1"]} in control["subjects"]
    assert {"subjects": ["r1"], "rules": ["what r1 says of itself"]} in control["policies"]


def test_no_robot_speaks_for_one_whose_name_begins_like_its_own():
    """There a robot has only its name."""
    assert own(access_control(("r1", "r1-tail")), "r1") == [
        f"@sendworthy/r1/{kind}/*" for kind in ("alive", "state", "digest", "fleet")
    ]


def test_operators_alone_may_order():
    """Where there are none nobody may."""
    rule = {
        "id": "orders",
        "permission": "allow",
        "messages": ["query"],
        "key_exprs": ["@sendworthy/*/fleet/*"],
        "flows": ["ingress"],
    }
    with_one, without = access_control(("r1", "ground"), ("ground",)), access_control(("r1", "ground"))
    assert rule in with_one["rules"]
    assert {"subjects": ["ground"], "rules": ["orders"]} in with_one["policies"]
    assert "orders" not in [each["id"] for each in without["rules"]]
    with pytest.raises(ValueError, match="boss: an operator is one of the robots, too"):
        access_control(("r1",), ("boss",))
