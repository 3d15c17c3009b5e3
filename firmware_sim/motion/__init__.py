"""How the table moves: segments, and profiles made of them."""
