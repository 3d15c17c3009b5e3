"""The config of `serve`: read strictly, checked, and followed while the service runs."""
