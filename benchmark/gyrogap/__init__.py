"""An open benchmark of causes of the gap between a simulator and recordings."""
