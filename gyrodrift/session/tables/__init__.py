"""Tables of other programs as sessions: text with any delimiter, JSON, Parquet, and known forms."""
