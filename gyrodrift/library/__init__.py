"""Public names of `gyrodrift`: filters, sessions, a device, and the analyses as functions."""
