"""Quarter turn to the left, and the meaning of text columns that follows from it."""
