"""Ranges that tell what a column can be, alike for lines of a device and for tables."""

TEMPERATURES_C = (-55.0, 150.0)
"""What parts are made for (military range, with what a junction may reach); beyond it, a temperature is in counts."""
