"""Where a daemon's processor time goes: sampled while somebody asks, and nothing at all otherwise."""
