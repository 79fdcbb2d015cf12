"""`sendworthy top`: a robot or the fleet, live in a terminal."""
