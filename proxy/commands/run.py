"""`sendworthy run`: the daemon of this robot."""

import argparse
import gc
import logging
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path

from proxy import clock, exit_codes
from proxy.commands.config_flags import LAYERS, add_config_flags, reader
from proxy.config import BridgeConfig, Config, MeshConfig
from proxy.config_files import standard, watched
from proxy.descriptors import raise_limit
from proxy.errors import ConfigError, ProxyError
from proxy.heap import Spare, give_back, keep_together
from proxy.log import set_up_logging
from proxy.lost_threads import LostThreads
from proxy.notices import Notices
from proxy.priority import lengthen_slice, raise_priority
from proxy.reloading import Reloading, read_besides, read_specs, warn
from proxy.requests import Requests
from proxy.service import Service
from proxy.version import version
from proxy.watching import Signature, signature
from utility_specs import Specs, SpecsError

log = logging.getLogger("sendworthy")

LOOK = 1.0
"""Time between two looks at files of which the kernel says nothing [s]; each wakes the processor."""
PAUSE = 0.2
"""A file that changed is read when it then stays as it is for so long [s]."""
PATIENCE = 4
"""So long a request to end may wait for files that are being read [s]: less than systemd waits (`TimeoutStopSec`)."""
FEEDS = 3
"""How often systemd hears of us in the time after which it would give up on us."""

DESCRIPTION = f"""\
Runs the daemon of this robot until SIGTERM or Ctrl-C. Utility specs and files of the configuration that change are put
in force at once, all of them or, where there is any mistake, none; SIGHUP has them read in any case. Of the
configuration `mode`, `log.level` and `specs.path` may change while it runs.

{LAYERS}
Values of variables and flags are written as in TOML; text needs no quotes. `sendworthy config` prints the result.
"""
EXAMPLES = """\
examples:
  sendworthy run --config sendworthy.toml
  sendworthy run --config sendworthy.toml --mode shadow --log.level debug
  sendworthy run --robot r1 --mesh.scouting false --mesh.connect '["tcp/10.0.0.2:7500"]'
  sendworthy run --app.zenoh.transport.shared_memory.enabled true
  SENDWORTHY_PLANNER__ITERATIONS=500 sendworthy run --config sendworthy.toml

exit codes:
  0   stopped by SIGTERM or Ctrl-C
  69  a port is in use, or Zenoh cannot start
  70  a part of it was lost, as after a fault of Zenoh: start it anew, as systemd does
  78  the configuration or the utility specs are wrong
"""


def command(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command, with a flag for every key of the configuration."""
    parser = subparsers.add_parser(
        "run",
        help="run the daemon of this robot",
        usage="sendworthy run [--config FILE] [--KEY VALUE ...]",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add_config_flags(parser, listed=True)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the daemon; return the exit code."""
    with Requests(PATIENCE) as asked:
        return run_until(asked, arguments)


def run_until(asked: Requests, arguments: argparse.Namespace) -> int:
    """Run the daemon until it is `asked` to stop; return the exit code."""
    layered, file = reader(arguments), standard(arguments.config)
    try:
        known = signature([] if file is None else watched(file))
        config = layered().config
        known = tuple(sorted({*known, *signature(read_besides(config))}))
        specs = read_specs(config.specs.path)
    except (ConfigError, SpecsError) as error:
        print(error, file=sys.stderr)
        return exit_codes.CONFIG
    set_up_logging(config.log, os.environ)
    for outdated in config.outdated:
        log.warning("%s", outdated)
    raise_limit()
    if raise_priority():  # before there are other threads: each takes after the one that starts it
        lengthen_slice()
    else:
        log.debug("not allowed to raise the priority of the daemon: beside busy processes it hears and decides late")
    lost = LostThreads()
    try:
        closed = serve(config, specs, asked, file, lambda: layered().config, known=known)
    except ConfigError as error:
        log.error("%s", error)
        return exit_codes.CONFIG
    except ProxyError as error:
        log.error("%s", error)
        return exit_codes.UNAVAILABLE
    finally:
        lost.close()
    code = exit_codes.BROKEN if lost.any else exit_codes.OK
    if not closed or others_run():  # a thread that returns from Zenoh or a search as Python ends aborts the process
        logging.shutdown()
        os._exit(code)
    return code


def serve(
    config: Config,
    specs: Specs,
    asked: Requests,
    file: Path | None,
    read: Callable[[], Config],
    *,
    known: Signature | None = None,
) -> bool:
    """Run the daemon until it is `asked` to stop; whether all is closed then. Raises ProxyError at start.

    Files were as `known` says before they were read.
    """
    from proxy.opening import Opening  # noqa: PLC0415 - Zenoh only when the configuration is right

    keep_together()
    gc.disable()  # nothing of all that is made now is garbage
    opening = Opening(config)
    with opening.closing as closing:
        from proxy.daemon import Daemon  # noqa: PLC0415 - while others of our name are listened for

        daemon, service = Daemon(config, specs, file, read, opening, known=known), Service(os.environ)
        opening.closing = closing.pop_all()
    daemon.start()
    notices, spare = Notices(), Spare()
    try:
        settle()
        log.info("%s", started(config, specs, daemon.robot))
        warn(daemon.reloading.loaded)
        service.ready(started(config, specs, daemon.robot))
        if service.watchdog is not None:
            daemon.watch(service.alive, service.watchdog / FEEDS)
        soon = look(daemon.reloading, notices)
        while (request := asked.next(PAUSE) if soon else asked.next(LOOK, notices.fileno())) in ("", "SIGHUP"):
            if not request:
                spare.look(clock.monotonic())
                soon = look(daemon.reloading, notices)
                continue
            service.reloading()
            daemon.reloading.reload(request)
            loaded = daemon.reloading.loaded
            in_force = loaded.config.model_copy(update={"mode": daemon.mode})
            service.ready(started(in_force, loaded.specs, daemon.robot))
        log.info("stopping on %s", request)
    finally:
        notices.close()
        service.stopping()
        closed = daemon.stop()
        service.close()
    return closed


def others_run() -> bool:
    """Whether another thread goes on: a daemon with too much to do does not wait for all of it when it stops."""
    return any(thread is not threading.current_thread() for thread in threading.enumerate())


def look(reloading: Reloading, notices: Notices) -> bool:
    """Look whether files changed; return whether to look again soon, as they do or something else does beside them."""
    notices.watch(reloading.watched())  # first, or what happens after the look would not be noticed
    noticed = notices.take()
    return reloading.look() or noticed


def settle() -> None:
    """Have what is there by now never looked through for garbage: that would stop all threads for 30 ms."""
    gc.freeze()
    gc.enable()
    give_back()


def broadcasting(config: Config) -> str:
    """Say where samples are broadcast; nothing in unicast."""
    mesh = config.mesh
    return f", broadcast on {mesh.group} ({mesh.interface})" if mesh.transport == "broadcast" else ""


def started(config: Config, specs: Specs, robot: str) -> str:
    """Describe the daemon in one line."""
    types, path = len(specs.types), config.specs.path
    covered = f"{types} information type{'s' * (types != 1)} from {path}"
    specs_in_force = f"specs {specs.generation} ({covered})" if types else f"no specs in {path}: everything passes"
    ruled = config.bridge != BridgeConfig()
    return (
        f"sendworthy {version()}: robot {robot}, mode {config.mode.value}, "
        f"apps on {_where(config.app.listen, config.app.connect)}{' with scouting' * config.app.scouting}, "
        f"mesh on {_mesh(config.mesh)}{' with scouting' * config.mesh.scouts}{broadcasting(config)}, {specs_in_force}"
        f"{f', rules of [bridge], profile {config.bridge.profile}' * ruled}"
        f"{f', metrics on http://{config.metrics.listen}/metrics' * bool(config.metrics.listen)}"
    )


def _where(listen: tuple[str, ...], routers: tuple[str, ...]) -> str:
    return " ".join([*listen, *(f"the router {endpoint}" for endpoint in routers)]) or "nothing"


def _mesh(mesh: MeshConfig) -> str:
    return _where(mesh.listens, mesh.connect if mesh.relayed else ())
