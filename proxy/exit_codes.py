"""What the command line's exit codes mean."""

OK = 0
FAILED = 1
"""A check failed, or nobody answered."""
USAGE = 2
"""The command line makes no sense."""
NOT_SEEN = 2
"""Nothing is wrong as far as could be looked, but not everything could be looked at (`sendworthy doctor`)."""
UNAVAILABLE = 69
"""The daemon cannot run here now: a port is in use (sysexits' EX_UNAVAILABLE)."""
BROKEN = 70
"""The daemon ended itself, as a part of it was lost (sysexits' EX_SOFTWARE)."""
CONFIG = 78
"""The configuration or the utility specs are wrong (sysexits' EX_CONFIG)."""
INTERRUPTED = 130
"""Ctrl-C ended a client command."""
