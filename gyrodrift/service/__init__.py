"""The running service: link → filter → sinks, in one thread."""
