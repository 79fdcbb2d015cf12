"""Traffic that was recorded by others, as a recording of Sendworthy: `sendworthy import`."""
