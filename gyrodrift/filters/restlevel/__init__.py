"""Restlevel: a Gaussian-sum filter over which constant-rate segments of the rate were rests.

The rate is cut into blocks. Stationary blocks of one mean are a constant-rate segment: a rest, whose mean is the bias,
or a spin at a constant rate. At each segment every hypothesis branches into these two. A hypothesis of rest takes
zero-velocity updates; one of a spin goes on turning. Hypotheses that agree are merged, improbable ones are pruned.

In reading order: `model` and `state` (the records), `step` (sample by sample), `noise`, `wander` and `segments` (what
the rate shows), `hypotheses`, `durations`, `kalman` and `mixture` (what may have happened), `witness`, `recall`,
`temperature` and `memory` (what is known beside the rate). Equations stand in docs/restlevel.md.

Prior art: sums of Gaussians as a filter (Alspach and Sorenson, "Nonlinear Bayesian estimation using Gaussian sum
approximations", IEEE Transactions on Automatic Control 17(4), 1972); a tree of hypotheses that is kept small (Reid, "An
algorithm for tracking multiple targets", IEEE Transactions on Automatic Control 24(6), 1979); models that are mixed by
their likelihoods (Blom and Bar-Shalom, "The interacting multiple model algorithm for systems with Markovian switching
coefficients", IEEE Transactions on Automatic Control 33(8), 1988); zero-velocity updates of inertial navigation; and
angle random walk N, bias instability B, rate random walk K and rate ramp R of IEEE Std 952.
"""
