"""Crashes: what writes is killed or gets no room; what was there before is there, or what was to be, and no half."""
