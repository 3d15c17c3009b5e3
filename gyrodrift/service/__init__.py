"""The running service: link → filter → outputs, in one thread."""
