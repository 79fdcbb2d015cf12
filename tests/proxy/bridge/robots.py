"""Robots whose decisions the test makes: two sessions and the bridge between them, without a core."""

from contextlib import ExitStack
from pathlib import Path
from typing import Any, TypeVar

import zenoh

from proxy.bridge.bridge import Bridge, CoreLink
from proxy.bridge.hold_back import HoldBack
from proxy.bridge.neighbours import Neighbours
from proxy.bridge.sides import open_sides
from proxy.config import AppConfig, BridgeConfig, Config, MeshConfig
from proxy.core.interface.events import Event, SamplePublished
from proxy.core.model.mode import Mode
from proxy.runtime import LiveRuntime, Runtime
from tests.proxy.nodes import closing, free_endpoint, pass_fence, plain_session
from tests.waiting import wait_until
from utility_specs import InformationType, Specs, load_specs

SPECS = """
version = 1
[[information_type]]
name = "covered"
keys = ["covered/**"]
utility = { kind = "video" }
"""


T = TypeVar("T")


class Robot:
    """One robot. `asked` are the samples that wait for the test's decision, `events` everything else posted."""

    def __init__(
        self,
        stack: ExitStack,
        specs: Specs,
        connect: tuple[str, ...] = (),
        rules: dict[str, Any] | None = None,
        **mesh_options: Any,
    ) -> None:
        self._stack = stack
        self.asked: list[SamplePublished] = []
        self.payloads: list[zenoh.ZBytes] = []
        self.attachments: list[bytes | None] = []
        self.events: list[Event] = []
        self.app_endpoint, self.mesh_endpoint = free_endpoint(), free_endpoint()
        self._config = config = Config(
            app=AppConfig(listen=(self.app_endpoint,)),
            mesh=MeshConfig(listen=(self.mesh_endpoint,), connect=connect, scouting=False, **mesh_options),
            bridge=BridgeConfig.model_validate(rules or {}),
        )
        self._live = LiveRuntime(Runtime(Mode.ENFORCE, specs))
        sides = self._sides = open_sides(config.app, config.mesh, stack)
        self.app, self.mesh, self.data, self.mirror = sides.app, sides.mesh, sides.data, sides.apps.session

    def begin(self) -> None:
        """Let things cross."""
        sides = self._sides
        neighbours = Neighbours(sides.app, "robot", str(sides.mesh.zid()), sides.wake.set)
        self._stack.callback(neighbours.close)
        core = CoreLink(self._submit, self.events.append, self.events.append, lambda _: None)
        self.bridge = Bridge(
            self._config, sides, self._live, neighbours=neighbours, hold_back=HoldBack(lambda _: ""), core=core
        )
        self._stack.callback(self.bridge.close)
        self.bridge.open()

    def switch(self, mode: Mode) -> None:
        """Put a mode in force."""
        self._live.switch(mode)
        self.bridge.renew()

    def swap(self, specs: Specs) -> None:
        """Put specs in force."""
        self._live.swap(specs)
        self.bridge.renew()

    def _submit(
        self,
        event: SamplePublished,
        _covering: InformationType,
        payload: zenoh.ZBytes,
        attachment: zenoh.ZBytes | None,
        *,
        each: bool,
    ) -> int | None:
        assert each is (self._live.match(event.key) is None)  # what passes gives way to nothing
        self.payloads.append(payload)
        self.attachments.append(None if attachment is None else attachment.to_bytes())
        self.asked.append(event)
        return None

    def node(self, mode: str = "client", *, stamps: bool = False) -> zenoh.Session:
        """An application of this robot."""
        listen = () if mode == "client" else ("tcp/127.0.0.1:0",)
        return closing(
            self._stack, plain_session(mode, listen=listen, connect=(self.app_endpoint,), stamps=stamps, gossip=True)
        )

    def posted(self, kind: type[T]) -> list[T]:
        """The events of one kind, in order."""
        return [event for event in list(self.events) if isinstance(event, kind)]


def team(
    stack: ExitStack,
    tmp_path: Path,
    size: int = 3,
    specs: str = SPECS,
    rules: tuple[dict[str, Any] | None, ...] = (None, None, None),
    **mesh_options: Any,
) -> list[Robot]:
    """Robots on a full mesh over loopback: each dials those before it. `rules` are the `[bridge]` of each."""
    path = tmp_path / "specs.toml"
    path.write_text(specs)
    loaded = load_specs(path)
    robots: list[Robot] = []
    for own in rules[:size]:
        robots.append(Robot(stack, loaded, tuple(robot.mesh_endpoint for robot in robots), own, **mesh_options))
    for robot in robots:
        robot.begin()
    wait_until(
        lambda: all(len(robot.mesh.info.peers_zid()) == size - 1 for robot in robots), what="the full mesh of links"
    )
    return robots


def wait_interest(robot: Robot, *others: Robot, keys: tuple[str, ...]) -> None:
    """Wait until `others` know that apps of `robot` subscribe to `keys`, and take what they match from their apps."""
    wait_until(lambda: set(keys) <= set(robot.bridge.describe()["subscriptions"]), what=f"the apps' {keys}")
    fence(robot, *others)
    for other in others:
        wait_until(lambda other=other: all(observes(other, key) for key in keys), what=f"{keys} on the other robot")


def observes(robot: Robot, key: str) -> bool:
    """Whether `robot` takes all that `key` matches from its apps."""
    return any(zenoh.KeyExpr(expression).includes(key) for expression in robot.bridge.describe()["observed"])


def fence(robot: Robot, *others: Robot) -> None:
    """Wait until all that `robot` has declared on the mesh is known to `others`: links keep the order."""
    pass_fence(robot.mesh, *(other.mesh for other in others))


def fence_apps(robot: Robot) -> None:
    """Wait until all that is mirrored for the apps of `robot` is known to their router."""
    pass_fence(robot.mirror, robot.app)
