"""A seeded network model that drives the daemon's own cores, without Zenoh and without real time."""
