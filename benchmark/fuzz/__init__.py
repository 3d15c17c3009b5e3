"""Fuzzing: whatever comes from outside is read, refused in our own words, or counted; nothing else happens."""
