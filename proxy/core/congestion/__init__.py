"""How much of adaptive limits the channel bears."""
