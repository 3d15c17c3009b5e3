"""Wire protocols, one file per protocol."""
