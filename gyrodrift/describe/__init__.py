"""What a recorded session holds: how its clock runs, what is missing, where the device rested, its noise."""
