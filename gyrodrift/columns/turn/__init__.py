"""Evidence of a quarter turn to the left: columns over time, their motions, scales, and the verdict."""
