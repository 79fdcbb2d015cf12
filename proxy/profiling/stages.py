"""The stages of a daemon's work, and which module belongs to which."""

from collections.abc import Iterable

INGRESS, FEATURES, CORE, WINDOW, TABULATION = "ingress", "features", "core", "window", "tabulation"
SEARCH, EGRESS, DIGESTS, BRIDGE, ZENOH, OTHER = "search", "egress", "digests", "bridge", "zenoh", "other"

STAGES = (INGRESS, FEATURES, CORE, WINDOW, TABULATION, SEARCH, EGRESS, DIGESTS, BRIDGE, ZENOH, OTHER)
"""In the order in which a sample meets them. `zenoh` is what its own threads do outside of Python, `other` the rest."""

_STAGES = {
    "proxy.bridge.ingress": INGRESS,
    "proxy.features": FEATURES,
    "proxy.background": FEATURES,
    "utility_specs.features": FEATURES,
    "proxy.core.window": WINDOW,
    "planner.tables": TABULATION,
    "planner.evaluation": TABULATION,
    "planner.native_engine": SEARCH,
    "planner.python_engine": SEARCH,
    "planner.engines": SEARCH,
    "proxy.planning": SEARCH,
    "proxy.worker": SEARCH,
    "proxy.bridge.egress": EGRESS,
    "proxy.bridge.sender": EGRESS,
    "proxy.bridge.writer": EGRESS,
    "proxy.core.gossip": DIGESTS,
    "proxy.core.protocol": DIGESTS,
    "proxy.bridge.presence": DIGESTS,
}
"""Packages and modules whose work is one stage, with all that they call on to do it."""

_REST = {"proxy.core": CORE, "proxy.loop": CORE, "proxy.execution": CORE, "proxy.bridge": BRIDGE}
"""What else is done in these packages, where nothing above has it done."""


def stage_of(modules: Iterable[str]) -> str:
    """Return the stage of a stack of modules, the innermost first: that of the innermost which has one.

    Beyond the loop it does not matter who had it work.
    """
    rest = OTHER
    for module in modules:
        stage = _of(module, _STAGES)
        if stage is not None:
            return stage
        if module == "proxy.loop" and rest != OTHER:
            return rest
        if rest == OTHER:
            rest = _of(module, _REST) or OTHER
    return rest


def _of(module: str, stages: dict[str, str]) -> str | None:
    while module:
        if module in stages:
            return stages[module]
        module = module.rpartition(".")[0]
    return None
