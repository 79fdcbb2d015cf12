"""Designs of the search that were tried: each decides windows from the planner's tables, to be compared.

    catalogue.py   all of them by name
    design.py      what they have in common
    paper.py       the search of §3.1, also with the maximum in place of the mean
    rollouts.py    UCT whose leaves a default policy completes
    beam.py        beam search
    ablations.py   best mode with one part left out or replaced, other uses of its parts
    dominance.py   best mode with dominance in place of equality
    priors.py      best mode that begins with what the last decision found
    literal.py     paper mode with things to the letter of §3
    counts.py      how many nodes whole trees have

They are small, not fast, and belong to no product: `planner/` holds the ones that won.
"""
