"""One posterior over sets of effects, their sizes and unknown effects."""
