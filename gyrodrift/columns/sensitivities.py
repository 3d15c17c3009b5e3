"""Sensitivities of gyros that print counts, from their data sheets, with the digits that sketches use."""

INVENSENSE = {250: 131.0, 500: 65.5, 1000: 32.8, 2000: 16.4}
"""Counts per deg/s by full scale, deg/s: MPU-6050 (PS-MPU-6000A), ICM-20948 (DS-000189). Bosch differs by 0.2 %."""

ST = {8.75: 114.28, 17.5: 57.14, 35.0: 28.57, 70.0: 14.29}
"""Counts per deg/s by step, mdeg/s, at ±250 to 2000 deg/s: LSM6DS3 (DocID026899), LSM6DSO (DS12140)."""

ST_FINEST = (4.375, 228.57)
"""Step, mdeg/s, and counts per deg/s at ±125 deg/s, which few sketches use."""

SENSITIVITIES = (*INVENSENSE.values(), *ST.values())
"""Counts per deg/s of common ranges."""
