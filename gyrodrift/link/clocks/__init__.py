"""Device time from counters, time stamps and arrivals."""
