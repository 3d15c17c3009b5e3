"""One motion that a person makes, a quarter turn to the left, and what it says of the columns of a text."""
