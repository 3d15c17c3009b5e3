"""Restlevel: drift learnt from the level that the rate keeps coming back to, with what is not known kept open."""
