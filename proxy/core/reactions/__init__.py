"""What each event changes in the parts of the core, and which commands follow from it."""
