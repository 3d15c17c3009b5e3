"""The diagnosed effects in the formats of other simulators."""
