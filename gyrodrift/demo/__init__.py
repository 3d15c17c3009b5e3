"""`gyrodrift demo`: the simulator and `serve` as processes of their own, watched by a view."""
