"""What some flight may have reached."""

from studies.simulation.traffic.scores import Score

SCORE = Score(
    utility=80.0,
    large=8.0,
    sent=900_000.0,
    offered=2e6,
    room=1e6,
    over=0.01,
    worst=1.2,
    sustained=0.9,
    largest=0.5,
    told=300.0,
    digests=200.0,
    allowed=2500.0,
    arrived=0.98,
    kept=0.99,
    age=(0.02, 0.03),
    alarms=7,
    alarms_sent=6,
    silence={"r0": 0.5, "r1": 1.5},
    has_small=True,
)
