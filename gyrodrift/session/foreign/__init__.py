"""Sessions of other programs: read where they fit, written where others want them."""
