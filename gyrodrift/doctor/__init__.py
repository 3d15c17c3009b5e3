"""A device or a recording looked at as a whole: evidence first, then one finding a check, each with what to do."""
