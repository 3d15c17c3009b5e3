"""What tune, compare and diagnose share: sessions with a reference, and how far a yaw is off it."""
