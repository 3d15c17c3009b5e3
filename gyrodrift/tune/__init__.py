"""Finding the filter's parameters from recorded sessions."""
