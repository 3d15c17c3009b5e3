"""Checks of a recording: its clock and the unit, sign and axis of its rates, as `serve` checks a stream."""
