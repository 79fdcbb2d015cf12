"""How many files and sockets the daemon may have open.

Services begin with a soft limit of 1,024, for programs that use select(2); others are meant to raise it themselves. At
that limit Zenoh accepts no link, of no application either, and goes on with none that it has half accepted: with TLS a
stranger who held a thousand connections open for a moment left a daemon like that for good.
"""

import resource

MOST = 16_384
"""A connection on which nothing was said yet takes 8 kB, so all of them fit in the memory of a service."""


def raise_limit(most: int = MOST) -> int:
    """Let this process have more open, as far as it may; return how many."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = most if hard == resource.RLIM_INFINITY else min(most, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        return wanted
    return soft
