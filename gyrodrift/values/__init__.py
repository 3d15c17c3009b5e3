"""Values that all packages share: samples, vectors, mount, calibration, errors and secrets."""
