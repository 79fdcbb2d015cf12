"""What is set from outside: limits, modes, settings."""
