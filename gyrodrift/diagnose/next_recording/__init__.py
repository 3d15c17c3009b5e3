"""The next recording: a motion chosen because it tells apart what the recordings so far do not."""
