"""Files, the log, processes and progress: what all packages need of the system."""
