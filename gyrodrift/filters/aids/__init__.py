"""Second sources of a filter: what they measure becomes evidence about yaw, about the bias, and about rest.

Reading order: `reading`, `errors`, `trust`, `motion`, `heading`, `turn_rate`, `standing`, `follow`. The filters take
the evidence in `restlevel.aided` and `attitude.aided`.
"""
