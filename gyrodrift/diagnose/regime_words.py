"""Regimes of the motion as a person says them."""

WHEN = {
    "rest": "at rest",
    "slow": "in slow motion",
    "fast": "in fast motion",
    "moving": "in motion",
    "accelerating": "while accelerating",
    "reversing": "after reversals",
    "warm": "as it warms or cools",
    "early": "soon after power-on",
    "late": "over time",
    "always": "at all times",
}
"""By the names that features give them."""
