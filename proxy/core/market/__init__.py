"""What room costs at present, which streams dispute it, and when it opens."""
