"""What can happen to the core, and what it asks its driver to do."""
