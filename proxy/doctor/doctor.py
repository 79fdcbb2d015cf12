"""Looks at everything, in the order in which a robot is set up."""

from collections.abc import Callable, Iterator

from proxy.bridge.loopback import has_ipv6, present
from proxy.commands.client import DAEMON, NoAnswerError, connected
from proxy.commands.credentials import Credentials, of_options
from proxy.config import Config
from proxy.config_loading import Layered
from proxy.doctor.certificates import certificates
from proxy.doctor.files import recordings, specs
from proxy.doctor.finding import Finding, finding, fine, mistake, unknown
from proxy.doctor.ports import ports
from proxy.doctor.radio import radio
from proxy.doctor.team import Status, alone, applications, team
from proxy.doctor.wall_clock import wall_clock
from proxy.errors import ConfigError
from proxy.extras import needs, there


def examine(read: Callable[[], Layered], where: str | None) -> Iterator[Finding]:
    """Look at this robot, with the configuration that `read` reads and the daemon at `where`.

    None: where the configuration has it listen.
    """
    try:
        layered = read()
    except ConfigError as error:
        yield from (mistake("configuration", problem) for problem in error.problems)
        yield unknown("robot", "what depends on the configuration is looked at when that is right")
        status = _asked(where or DAEMON, None)
        yield from alone(status) if isinstance(status, str) else team(status, None)
        return
    config = layered.config
    status = _asked(where or _endpoint(config), config.robot, of_options(config.app.zenoh))
    yield from _configuration(layered)
    yield from _host(config, None if isinstance(status, str) else status)
    if isinstance(status, str):
        yield from alone(status)
        yield from applications(config.mesh.interface)
    else:
        yield from team(status, config)


def _host(config: Config, status: Status | None) -> Iterator[Finding]:
    """Look at what there is without other robots."""
    listen = (*present(config.app.listen, ipv6=has_ipv6()), *config.mesh.listens)
    metrics = (f"tcp/{config.metrics.listen}",) if config.metrics.listen else ()
    told = status.get("daemon", {}) if status else {}
    ours = (*told.get("app", ()), *told.get("mesh", ()), *metrics) if status else ()
    yield from ports((*listen, *metrics), ours)
    yield from radio(config.mesh, running=status is not None)
    yield from wall_clock(config)
    yield from certificates(config)
    yield from specs(config.specs.path)
    yield from recordings(config.record, config.robot)


def _configuration(layered: Layered) -> Iterator[Finding]:
    config, files = layered.config, layered.files
    found = [*config.outdated]
    if config.record.on and not there("mcap"):
        found.append(f"record {needs('record')}")
    yield from (finding("configuration", text) for text in found)
    if not found:
        read = ", ".join(str(source.path) for source in files.sources if source.text) or "no file"
        yield fine("configuration", f"right ({read}; sendworthy config prints it)")


def _asked(where: str, robot: str | None, own: Credentials | None = None) -> Status | str:
    """Return the status of the daemon at an endpoint, of several that of `robot`; or why there is none.

    With its `own` credentials, as far as they are known.
    """
    try:
        with connected(where, own or None) as client:
            answers = client.status(None)
    except NoAnswerError as error:
        return str(error)
    return next((status for status in answers if status["robot"] == robot), answers[0])


def _endpoint(config: Config) -> str:
    """Return where applications of this robot reach the daemon, or the router that it links to."""
    first = next(iter((*config.app.listen, *config.app.connect)), DAEMON)
    return first.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")
