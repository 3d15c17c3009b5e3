"""The next recording: a motion that separates the hypotheses which the recordings so far leave open."""
