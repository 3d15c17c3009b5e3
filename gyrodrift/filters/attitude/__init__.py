"""Attitude and heading from three gyro axes and an accelerometer: a Gaussian sum of error-state Kalman filters.

Reading order: `model`, `block`, `hypotheses`, `predict`, `measure`, `rests`, `evidence`, `regimes`, `segments`,
`mixture`, `knowledge`, `update`, `step`. The module docstrings say what these files contain.
`docs/attitude.md` has the equations.

Only this package of the filters imports numpy; `serve` imports it when a stream has six axes.
"""
