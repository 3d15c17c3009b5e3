"""The checks by what they look at; `registry` has all of them in the order in which they are told."""
