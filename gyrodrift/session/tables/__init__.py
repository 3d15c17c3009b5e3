"""Tables of other programs as sessions: text with any delimiter, JSON, and the known heads of apps and loggers."""
