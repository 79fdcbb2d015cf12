"""The configuration of the daemon, as people write it. `deploy/sendworthy.toml` is its manual.

Every field has a default; the description of a field is the help of its flag.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationInfo, field_validator, model_validator

from proxy.config_values import (
    SECURED,
    FleetToken,
    HttpAddress,
    Interface,
    KeyExpressions,
    ListenEndpoints,
    MulticastGroup,
    RemoteEndpoints,
    RobotName,
    SpecsPath,
    this_robot,
)
from proxy.core.model.mode import Mode
from proxy.fleet_token import read_token

ZenohTable = dict[str, Any]
"""Any part of a Zenoh configuration, deep-merged over ours."""


class Section(BaseModel):
    """What all tables share: frozen, strictly typed, no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class AppConfig(Section):
    """`[app]`: the side of the robot's own applications."""

    connect: RemoteEndpoints = Field(
        default=(), description="endpoints of routers of this robot that its applications are connected to"
    )
    listen: ListenEndpoints = Field(
        default=("tcp/127.0.0.1:7447", "tcp/[::1]:7447"),
        description="endpoints where this robot's applications connect",
    )
    scouting: bool = Field(
        default=False, description="answer applications that look for a router by Zenoh's default multicast"
    )
    zenoh: ZenohTable = Field(default={}, description="further Zenoh configuration of the application side")

    @field_validator("listen")
    @classmethod
    def _reachable(cls, listen: tuple[str, ...], given: ValidationInfo) -> tuple[str, ...]:
        if not listen and not given.data.get("connect"):
            raise ValueError("must not be empty, unless connect names a router")
        return listen


class MeshConfig(Section):
    """`[mesh]`: the side of the other robots."""

    mode: Literal["peer", "client"] = Field(
        default="peer", description="peer: robots are linked each to each; client: they meet at a router"
    )
    listen: ListenEndpoints = Field(default=("tcp/0.0.0.0:7500",), description="endpoints where other robots connect")
    connect: RemoteEndpoints = Field(
        default=(), validate_default=True, description="endpoints of other robots, or of routers, to dial"
    )
    scouting: bool = Field(
        default=True, description="find other robots by multicast; false: only named endpoints are dialled"
    )
    interface: Interface = Field(default="auto", description="network interface of the radio")
    transport: Literal["unicast", "broadcast"] = Field(
        default="unicast", description="unicast: a copy of a sample for each robot; broadcast: one for all"
    )
    group: MulticastGroup = Field(
        default="224.0.0.226:7449", description="multicast group and port on which samples are broadcast"
    )
    allowance: float = Field(
        default=0.02, ge=0.0, le=0.5, description="share of every limit for what the daemons tell each other"
    )
    zenoh: ZenohTable = Field(default={}, description="further Zenoh configuration of the mesh side")

    @field_validator("connect")
    @classmethod
    def _meets(cls, connect: tuple[str, ...], given: ValidationInfo) -> tuple[str, ...]:
        if not connect and given.data.get("mode") == "client":
            raise ValueError('must name a router in mode "client"')
        return connect

    @property
    def relayed(self) -> bool:
        """Whether everything between robots goes through a router."""
        return self.mode == "client"

    @property
    def secured(self) -> bool:
        """Whether robots know by TLS who speaks, at least on some links."""
        return any(endpoint.partition("/")[0] in SECURED for endpoint in (*self.listens, *self.connect))

    @property
    def listens(self) -> tuple[str, ...]:
        """Where other robots connect in this mode."""
        return () if self.relayed else self.listen

    @property
    def scouts(self) -> bool:
        """Whether other robots are looked for in this mode."""
        return self.scouting and not self.relayed


class InConfig(Section):
    """`[bridge.in]`: what others offer and this robot takes."""

    allow: KeyExpressions = Field(default=("**",), description="key expressions of what this robot takes from others")
    deny: KeyExpressions = Field(default=(), description="key expressions of what it does not take, allowed or not")


class OutConfig(Section):
    """`[bridge.out]`: what this robot offers to others."""

    allow: KeyExpressions = Field(default=("**",), description="key expressions of what this robot gives to others")
    deny: KeyExpressions = Field(default=(), description="key expressions of what it keeps to itself, allowed or not")
    bypass: KeyExpressions = Field(
        default=(), description="key expressions of samples that go at once, whatever specs and planner say"
    )


class BridgeConfig(Section):
    """`[bridge]`: what may cross between the applications and the mesh."""

    profile: Literal["none", "ros2"] = Field(default="none", description="ready-made rules that are added to yours")
    out: OutConfig = OutConfig()
    into: InConfig = Field(default=InConfig(), alias="in")


class SpecsConfig(Section):
    """`[specs]`: where the utility specs are."""

    path: SpecsPath = Field(default=Path("specs.d"), description="a file or a folder of *.toml with the utility specs")


class FleetConfig(Section):
    """`[fleet]`: which orders of an operator at another robot this one obeys."""

    specs: bool = Field(default=False, description="take the utility specs that are pushed to all robots")
    mode: bool = Field(default=False, description="switch to the mode that all robots are switched to")
    token: FleetToken = Field(
        default="", description="obey only who proves to know this token; better in a file than in a flag"
    )
    token_file: str = Field(default="", description="the same, with the token in this file")

    @model_validator(mode="after")
    def _one_token(self) -> Self:
        if self.token and self.token_file:
            raise ValueError("token and token_file exclude each other")
        return self

    @property
    def secret(self) -> str:
        """The token; nothing: there is none. Raises ValueError when its file cannot be read."""
        return read_token(Path(self.token_file)) if self.token_file else self.token


class PlannerConfig(Section):
    """`[planner]`: how decisions are made."""

    iterations: int = Field(default=300, ge=1, le=1_000_000, description="iterations of the tree search per decision")
    deadline: float = Field(
        default=0.02, ge=0.001, le=10.0, description="a decision takes at most this long from its event on [s]"
    )
    horizon: int = Field(default=120, ge=1, le=10_000, description="contested messages that a decision looks at")
    backlog: int = Field(
        default=32, ge=1, le=256, description="samples of a stream that may wait where more than the newest counts"
    )
    search: Literal["best", "paper"] = Field(default="best", description="kind of search")
    engine: Literal["native", "python"] = Field(default="native", description="who searches")
    coordination: Literal["announce", "split"] = Field(
        default="announce",
        description="how robots keep a limit together: each plans for all, or each has a part of it",
    )


class QueueConfig(Section):
    """`[queue]`: what may wait on its way out."""

    samples: int = Field(default=4096, ge=64, le=1_000_000, description="samples that may wait")
    bytes: int = Field(
        default=32 * 1024 * 1024, ge=65536, le=1 << 40, description="bytes of them [B]; a sample counts as at most half"
    )


class ClockConfig(Section):
    """`[clock]`: how right the wall clock of this robot is."""

    error: float = Field(
        default=0.0,
        ge=0.0,
        le=1.0,
        description="what the wall clock is wrong by at most while it is synchronised [s]; 0: not known",
    )


class LogConfig(Section):
    """`[log]`: what the daemon writes to standard error."""

    level: Literal["debug", "info", "warning", "error"] = Field(
        default="info", description="least level that is logged"
    )
    format: Literal["text", "json"] = Field(
        default="text", description="text: a line to read for each event; json: an object a line"
    )


class MetricsConfig(Section):
    """`[metrics]`: what Prometheus can read."""

    listen: HttpAddress = Field(default="", description="host and port where metrics are served; nothing: nowhere")


class RecordConfig(Section):
    """`[record]`: what the daemon writes of all that its core sees and decides."""

    on: bool = Field(default=False, description="record from the start of the daemon on")
    folder: SpecsPath = Field(default=Path("recordings"), description="folder of the recordings")
    file_bytes: int = Field(
        default=64 * 1024 * 1024, ge=1024 * 1024, le=1 << 40, description="size before which a new file is begun [B]"
    )
    disk_bytes: int = Field(
        default=1024 * 1024 * 1024,
        ge=2 * 1024 * 1024,
        le=1 << 50,
        description="what all recordings of this robot may take [B]; the oldest go first",
    )
    payloads: bool = Field(default=False, description="record the payloads of samples, too")

    @model_validator(mode="after")
    def _room(self) -> Self:
        if self.disk_bytes < 2 * self.file_bytes:
            raise ValueError(f"disk_bytes must be at least twice file_bytes, {2 * self.file_bytes}")
        return self


class Config(Section):
    """All settings of one daemon."""

    robot: RobotName = Field(default_factory=this_robot, description="name of this robot (default: the host name)")
    mode: Annotated[Mode, Field(strict=False)] = Field(default=Mode.ENFORCE, description="pass, shadow or enforce")
    app: AppConfig = AppConfig()
    mesh: MeshConfig = MeshConfig()
    bridge: BridgeConfig = BridgeConfig()
    specs: SpecsConfig = SpecsConfig()
    fleet: FleetConfig = FleetConfig()
    planner: PlannerConfig = PlannerConfig()
    queue: QueueConfig = QueueConfig()
    clock: ClockConfig = ClockConfig()
    log: LogConfig = LogConfig()
    record: RecordConfig = RecordConfig()
    metrics: MetricsConfig = MetricsConfig()

    _outdated: tuple[str, ...] = PrivateAttr(default=())

    def model_post_init(self, context: Any) -> None:
        """Take note of what was outdated in the values, which is told as the `context` of their validation."""
        self._outdated = context or ()

    @property
    def outdated(self) -> tuple[str, ...]:
        """What is written as older versions had it, and what it means now, each with its place."""
        return self._outdated


@dataclass(frozen=True, slots=True)
class Setting:
    """One key of the configuration: path, default, description, and what a flag or variable holds."""

    path: tuple[str, ...]
    default: Any
    description: str
    takes_text: bool
    takes_table: bool
    values: tuple[str, ...]
    """All that it can be, where these are few words."""

    @property
    def key(self) -> str:
        """The path as people write it: `planner.iterations`."""
        return ".".join(self.path)


def settings(model: type[BaseModel] = Config, path: tuple[str, ...] = ()) -> Iterator[Setting]:
    """Yield every key of the configuration in the order of the manual."""
    for name, field in model.model_fields.items():
        kind = field.annotation
        here = (*path, field.alias or name)
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            yield from settings(kind, here)
        else:
            yield Setting(
                path=here,
                default=field.get_default(call_default_factory=True),
                description=field.description or "",
                takes_text=kind not in (bool, int, float) and get_origin(kind) not in (tuple, dict),
                takes_table=get_origin(kind) is dict,
                values=_values(kind),
            )


def _values(kind: Any) -> tuple[str, ...]:
    if kind is bool:
        return "true", "false"
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return tuple(kind)
    return get_args(kind) if get_origin(kind) is Literal else ()
