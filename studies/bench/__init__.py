"""A benchmark for whoever decides what a robot sends: missions as files, any policy to fly them, and a leaderboard."""
