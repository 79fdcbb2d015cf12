"""Which stage a stack belongs to."""

import importlib

import pytest

from proxy.profiling import stages
from proxy.profiling.stages import STAGES, stage_of


@pytest.mark.parametrize(
    ("stage", "modules"),
    [
        ("ingress", ["proxy.bridge.demand", "proxy.bridge.ingress", "proxy.bridge.deduplication"]),
        ("features", ["cv2", "utility_specs.features.image", "utility_specs.specs", "proxy.features", "threading"]),
        ("features", ["proxy.loop", "proxy.features", "proxy.bridge.ingress"]),
        ("core", ["proxy.core.samples.gate", "proxy.core.core", "proxy.loop", "proxy.features", "threading"]),
        ("bridge", ["proxy.bridge.payloads", "proxy.execution", "proxy.loop", "proxy.bridge.ingress"]),
        ("core", ["planner.utility.base", "proxy.core.market.prices", "proxy.core.core", "proxy.loop"]),
        ("core", ["proxy.core.interface.commands", "proxy.execution", "proxy.loop", "threading"]),
        ("window", ["proxy.core.view.stream", "proxy.core.window.problem", "proxy.core.samples.gate", "proxy.loop"]),
        ("tabulation", ["numpy", "planner.received", "planner.tables", "planner.engines", "proxy.worker"]),
        ("search", ["planner.native_engine", "proxy.worker", "threading"]),
        ("egress", ["proxy.bridge.demand", "proxy.bridge.writer", "proxy.bridge.egress", "proxy.execution"]),
        ("digests", ["proxy.core.view.streams", "proxy.core.gossip.digest_composer", "proxy.core.core"]),
        ("digests", ["proxy.core.protocol.checked", "proxy.bridge.presence"]),
        ("bridge", ["proxy.bridge.rules", "proxy.bridge.delivery"]),
        ("bridge", ["proxy.bridge.payloads", "proxy.bridge.bridge", "proxy.execution", "proxy.loop"]),
        ("other", ["proxy.watching", "proxy.commands.run", "threading"]),
        ("other", []),
    ],
)
def test_the_innermost_module_that_has_a_stage_decides(stage, modules):
    """With all that it calls on; what else the core and the bridge do is theirs."""
    assert stage_of(modules) == stage


def test_every_module_that_is_named_is_there():
    """One that is renamed must be renamed there, too."""
    for module, stage in (stages._STAGES | stages._REST).items():
        importlib.import_module(module)
        assert stage in STAGES
