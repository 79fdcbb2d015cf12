"""The daemon: sessions, shared view, gate, status, command line."""
