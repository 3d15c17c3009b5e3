"""The files of a tuning: config, numbers, page."""
