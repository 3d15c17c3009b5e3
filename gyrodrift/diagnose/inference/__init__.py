"""From features and simulations to causes with probabilities."""
