"""Whether metrics can be served. Apart from what serves them, which loads much that few daemons need."""

from importlib.util import find_spec

from proxy.errors import ConfigError


def check_installed(listen: str) -> None:
    """Raise ConfigError if metrics are to be served and what serves them is not installed."""
    if listen and find_spec("prometheus_client") is None:
        raise ConfigError(("metrics.listen needs prometheus-client: pip install 'sendworthy[metrics]'",))
