"""The config of `serve`: read strictly, checked, watched while the service runs."""
