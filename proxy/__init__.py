"""The daemon: sessions, shared view, gate, status, command line."""

import os

from proxy.no_plugins import leave_out

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when NumPy is imported; nothing here is large enough for more
leave_out()
