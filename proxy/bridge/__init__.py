"""Zenoh sessions and everything that crosses between the apps and the mesh."""
