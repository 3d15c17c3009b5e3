"""Device time from counters, stamps and arrivals."""
