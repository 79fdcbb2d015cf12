"""Flights in which each robot decides alone, by a policy and by what it heard, over a network that loses and delays."""
