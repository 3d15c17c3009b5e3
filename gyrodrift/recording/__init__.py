"""Recording of samples, link events and raw bytes into files that survive a kill, without waiting for the disk."""
