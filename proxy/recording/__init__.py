"""What the core saw and decided, in files: MCAP, which Foxglove opens (`docs/reference/recordings.md`)."""
