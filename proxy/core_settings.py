"""What the core is told of the configuration."""

from proxy import clock
from proxy.config import Config
from proxy.core.model.settings import UNICAST, CoreSettings, broadcast
from proxy.tuning import TUNING
from proxy.version import version


def core_settings(config: Config, robot: str, zid: str) -> CoreSettings:
    """Return the settings of the core of `robot`, whose mesh session is `zid`."""
    planner, mesh = config.planner, config.mesh
    return CoreSettings(
        robot=robot,
        zid=zid,
        mode=config.mode,
        horizon=planner.horizon,
        iterations=planner.iterations,
        deadline=planner.deadline,
        inbox=config.queue.samples // 2,
        inbox_bytes=config.queue.bytes // 2,
        backlog=planner.backlog,
        coordination=planner.coordination,
        transport=broadcast(mesh.group) if mesh.transport == "broadcast" else UNICAST,
        allowance=mesh.allowance,
        relayed=mesh.relayed,
        # Where TLS says who speaks on the mesh, what anybody can broadcast is not believed.
        digests_on_air=mesh.transport == "broadcast" and not mesh.secured,
        wall_offset=clock.wall_offset(),
        version=version(),
        away=TUNING.away,
    )
