"""What can be wrong with a recording."""

from proxy.errors import ProxyError


class RecordingError(ProxyError):
    """A file cannot be read or written as a recording; the message says which, why, and what to do."""
