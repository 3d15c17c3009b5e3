"""What other programs import from `gyrodrift` itself: filters, sessions, a device, and the analyses as functions."""
