"""What nodes declare and ask on one side of the daemon, read from Zenoh's wire.

All that depends on how Zenoh writes its messages, and on what it tells whom, is in this package. The rest of the bridge
uses `Declarations` (`declarations.py`) and, before it opens a main session, `PrivateEndpoint`.
"""
