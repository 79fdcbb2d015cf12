"""Access control for a team in which every robot has a certificate of its own: Zenoh's rules, made from their names.

Zenoh tells a daemon no sender of a sample, but it knows the certificate at the other end of each link. So a robot takes
what daemons say of themselves only from the one whose name the certificate has.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from proxy.bridge.keys import OF_PLUGINS, PREFIX

ALL = (
    *("put", "delete", "query", "reply", "declare_subscriber", "declare_queryable"),
    *("liveliness_token", "liveliness_query", "declare_liveliness_subscriber"),
)
"""Everything that Zenoh has rules for."""
DATA = ("**", "**/@adv/**", "@ros2_lv/**", *OF_PLUGINS)
"""What applications say: keys without chunks that begin with `@`, those of advanced publishers, ROS 2 and bridges."""
COPIES = (f"{PREFIX}/*/kept/**", f"{PREFIX}/*/backlog/*")
"""What goes to one robot alone; the session that it goes to is in the key, and who sends it is not."""
TOLD = ("alive", "state", "digest")
"""What robots say of themselves."""
ORDERS = f"{PREFIX}/*/fleet/*"
_SHARED = ["all to the team", "what applications say", "what the team asks", "copies"]

Rule = dict[str, Any]


def access_control(robots: Sequence[str], operators: Sequence[str] = ()) -> dict[str, Any]:
    """Return Zenoh's access control: `robots` take part, `operators` among them may order all.

    The common name of each certificate is the name of its robot. Raises ValueError for an operator that is no robot.
    """
    if unknown := sorted(set(operators) - set(robots)):
        raise ValueError(f"{', '.join(unknown)}: an operator is one of the robots, too")
    names = list(dict.fromkeys(robots))
    own = {name: _of(name, names) for name in names}
    subjects: list[Rule] = [
        {"id": "this daemon itself", "link_protocols": ["unixsock-stream"]},
        {"id": "the team", "cert_common_names": names},
        *({"id": name, "cert_common_names": [name]} for name in names),
    ]
    policies = [
        {"subjects": ["this daemon itself"], "rules": ["everything"]},
        {"subjects": ["the team"], "rules": _SHARED},
        *({"subjects": [name], "rules": [f"what {name} says of itself"]} for name in names),
    ]
    rules = [*_common(), *(_own(name, chunks) for name, chunks in own.items())]
    if operators:
        rules.append(_rule("orders", ("query",), (ORDERS,), "ingress"))
        policies.append({"subjects": list(dict.fromkeys(operators)), "rules": ["orders"]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "subjects": subjects,
        "policies": policies,
        "rules": rules,
    }


def _common() -> Iterator[Rule]:
    """Yield what holds for all robots alike."""
    told = tuple(f"{PREFIX}/*/{kind}/*" for kind in TOLD)
    asked = ("query", "declare_subscriber", "liveliness_query", "declare_liveliness_subscriber")
    yield _rule("everything", ALL, (*DATA, f"{PREFIX}/**"))
    yield _rule("all to the team", ALL, (*DATA, f"{PREFIX}/**"), "egress")
    yield _rule("what applications say", ALL, DATA, "ingress")
    yield _rule("what the team asks", asked, (*told, *COPIES), "ingress")
    yield _rule("copies", ("put", "delete"), COPIES, "ingress")


def _own(name: str, chunks: Iterable[str]) -> Rule:
    """Return what one robot alone may say."""
    keys = [f"{PREFIX}/{chunk}/{kind}/*" for chunk in chunks for kind in (*TOLD, "fleet")]
    return _rule(
        f"what {name} says of itself", ("put", "reply", "declare_queryable", "liveliness_token"), keys, "ingress"
    )


def _of(name: str, names: Iterable[str]) -> list[str]:
    """Return the chunks of keys that are a robot's: its name, and what it is called while another has its name."""
    again = f"{name}-"
    return [name] if any(other.startswith(again) for other in names) else [name, f"{again}$*"]


def _rule(name: str, messages: Iterable[str], keys: Iterable[str], *flows: str) -> Rule:
    rule: Rule = {"id": name, "permission": "allow", "messages": list(messages), "key_exprs": list(keys)}
    return rule | {"flows": list(flows)} if flows else rule
