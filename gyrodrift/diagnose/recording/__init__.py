"""Sessions as a diagnosis sees them: on an even grid, checked, with their outliers and their motion known."""
