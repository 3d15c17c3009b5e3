"""Recording: samples, link events and raw bytes into files that survive a kill, without ever waiting for a disk."""
