"""Restlevel: a Gaussian-sum filter over which constant-rate segments of the rate were rests.

The rate is cut into blocks. A run of stationary blocks with the same mean is a constant-rate segment. It is a rest,
whose mean is the bias, or a spin at a constant rate. At each segment every hypothesis branches into these two. A
hypothesis of rest takes zero-velocity updates. A hypothesis of a spin integrates the rate. Hypotheses that agree are
merged, and improbable hypotheses are pruned.

In reading order:

- `model`, `bias_state` and `rate_state`: parameters and state;
- `step`: samples and blocks;
- `noise`, `frozen`, `wander` and `segments`: tests of the rate;
- `hypotheses`, `durations`, `kalman`, `slide`, `turns` and `mixture`: the Gaussian sum;
- `witness`, `temperature`, `recall` and `memory`: a rest sensor, a thermometer, and earlier runs;
- `zero`: restart of the yaw sigma.

docs/restlevel.md has the equations.

Prior art: sums of Gaussians as a filter (Alspach and Sorenson, "Nonlinear Bayesian estimation using Gaussian sum
approximations", IEEE Transactions on Automatic Control 17(4), 1972); a tree of hypotheses that is kept small (Reid, "An
algorithm for tracking multiple targets", IEEE Transactions on Automatic Control 24(6), 1979); models that are mixed by
their likelihoods (Blom and Bar-Shalom, "The interacting multiple model algorithm for systems with Markovian switching
coefficients", IEEE Transactions on Automatic Control 33(8), 1988); zero-velocity updates of inertial navigation; and
angle random walk N, bias instability B, rate random walk K and rate ramp R of IEEE Std 952.
"""
