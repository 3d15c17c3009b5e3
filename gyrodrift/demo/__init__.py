"""`gyrodrift demo`: the simulator and `serve` as processes, with a live view."""
