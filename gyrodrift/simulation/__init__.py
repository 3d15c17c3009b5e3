"""Sessions from the simulated rig, and recorded ones played again."""
