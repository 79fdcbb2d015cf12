"""What daemons tell each other, as data and as bytes."""
