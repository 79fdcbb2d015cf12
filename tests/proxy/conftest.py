import sys
import threading

import pytest
import zenoh


@pytest.fixture(autouse=True)
def _patience(monkeypatch):
    """Commands that are run here wait for a daemon that has no processor for longer than operators do."""
    monkeypatch.setattr("proxy.commands.client.TIMEOUT", 60.0)


@pytest.fixture(autouse=True)
def _traced_callbacks(monkeypatch):
    """Coverage follows only threads that Python started: hand its tracer to those in which Zenoh calls back."""
    tracer = threading.gettrace()
    if tracer is None:
        return
    make = zenoh.handlers.Callback

    def traced(callback, drop=None, *, indirect=True):
        def call(argument):
            if sys.gettrace() is None:
                sys.settrace(tracer)
            return callback(argument)

        return make(call, drop, indirect=indirect)

    monkeypatch.setattr(zenoh.handlers, "Callback", traced)
