"""What can go wrong with the daemon, each with what to do about it."""


class ProxyError(Exception):
    """Base of everything the daemon reports as one clear line instead of a traceback."""


class CommandError(ProxyError):
    """A command of the command line cannot be loaded."""


class SessionError(ProxyError):
    """A Zenoh session could not be opened: an endpoint or a Zenoh setting that Zenoh refuses."""


class PortInUseError(SessionError):
    """A listen endpoint is taken by another process."""


class ConfigError(ProxyError):
    """The configuration cannot be used. `problems` names all mistakes, each with its line, variable or flag."""

    def __init__(self, problems: tuple[str, ...]) -> None:
        super().__init__("\n".join(problems))
        self.problems = problems


class MetricsError(ProxyError):
    """The metrics cannot be served where the configuration says."""


class PageError(ProxyError):
    """The page cannot be served where it shall be, or its browser asks for what there is not."""


class PushError(ProxyError):
    """Specs cannot be pushed, or what was pushed cannot be taken: not for what stands in them."""
