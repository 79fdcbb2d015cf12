"""A daemon of the page's own, for an operator's machine on which none runs: so the page joins the mesh by itself."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from proxy.config_loading import load_config
from proxy.daemon import Daemon
from proxy.errors import PageError
from proxy.log import set_up_logging
from proxy.page.tuning import TUNING
from proxy.reloading import read_specs


@contextmanager
def own_daemon(file: Path) -> Iterator[str]:
    """Run the daemon of a configuration in this process; give where it listens for applications, such as the page.

    Files that change are put in force, as `sendworthy run` does it. Raises ProxyError and SpecsError.
    """
    read = partial(load_config, file, os.environ, {})
    config = read()
    if not config.app.listen:
        raise PageError(f"{file}: app.listen: the page needs a place where the daemon listens")
    daemon = Daemon(config, read_specs(config.specs.path), file, read)
    set_up_logging(config.log, os.environ)
    daemon.start()
    ended = threading.Event()
    looking = threading.Thread(target=_look, args=(daemon, ended), name="files")
    looking.start()
    try:
        yield config.app.listen[0]
    finally:
        ended.set()
        looking.join()
        daemon.stop()


def _look(daemon: Daemon, ended: threading.Event) -> None:
    while not ended.wait(TUNING.look):
        daemon.reloading.look()
