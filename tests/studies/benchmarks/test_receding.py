"""The exact receding-horizon optimiser beside best mode."""


def test_its_tables_say_what_a_decision_took_and_what_was_proven(measured):
    """Only the exact ones speak of proofs."""
    notes = [table.note for table in measured("receding")]
    assert all("A decision took" in note for note in notes)
    assert ["without proof: 0" in note for note in notes] == [False, True, True]
