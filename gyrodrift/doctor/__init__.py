"""Check of a device or a recording: evidence first, then a finding per check, with advice."""
