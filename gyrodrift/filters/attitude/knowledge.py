"""Memory and temperature on three axes, by the rules of restlevel for each axis.

`restlevel.memory` says which biases to begin with, and `restlevel.temperature` how a bias follows the temperature.
Here both act on the hypotheses of three axes.
"""

import numpy as np

from gyrodrift.filters.attitude.batch import rotation_matrices
from gyrodrift.filters.attitude.block import RAD
from gyrodrift.filters.attitude.evidence import JUMP_SHARE, MODEL_ERROR, normal_density
from gyrodrift.filters.attitude.hypotheses import BIAS, REST
from gyrodrift.filters.attitude.mixture import ordered
from gyrodrift.filters.attitude.model import AttitudeCoefficients, AttitudeState
from gyrodrift.filters.attitude.witness import STILL
from gyrodrift.filters.restlevel.bias_state import MAX_REMEMBERED
from gyrodrift.filters.restlevel.model import UNKNOWN_C
from gyrodrift.filters.restlevel.recall import note_sure_rest
from gyrodrift.filters.restlevel.temperature import follow_line, learn_level
from gyrodrift.values.arrays import Mask


def begin_remembered(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Add hypotheses for the remembered biases to that of an unknown sensor, which keeps the other probability.

    A bias that has jumped about the vertical alone looks like an even turn of a known sensor. So the most probable
    remembered bias also has a hypothesis whose vertical component is unknown again.
    """
    slots = [[axis.remembered[index] for axis in s.axes] for index in range(MAX_REMEMBERED)]
    slots = sorted(
        (slot for slot in slots if min(bias.weight for bias in slot) > 0.0), key=lambda slot: -slot[0].weight
    )
    if not slots:
        return
    h = s.hypotheses.select([0] * (2 + len(slots)))
    up = rotation_matrices(h.q[:1])[0, 2]
    for index, slot in enumerate((slots[0], *slots), 1):
        h.weight[index] = slot[0].weight * (1.0 - JUMP_SHARE)
        h.bias[index] = np.radians([bias.bias_dps for bias in slot])
        h.cov[index, BIAS, BIAS] = np.diag([RAD**2 * bias.bias_var + c.walk_var for bias in slot])
        h.knows_bias[index] = True
    remembered = sum(slot[0].weight for slot in slots)
    h.weight[:2] = 1.0 - remembered, JUMP_SHARE * remembered
    h.cov[1, BIAS, BIAS] += c.bias_sigma**2 * np.outer(up, up)
    s.hypotheses, s.remembers = ordered(h), True


def drop_wrong_memory(c: AttitudeCoefficients, s: AttitudeState) -> None:
    """Drop the remembered biases once a jump about the vertical or an unknown sensor is more probable in motion.

    Both begin with wider priors, and contain the remembered bias m. Their density at m, over that of their prior,
    multiplies the odds of the memory (Dickey, Annals of Mathematical Statistics 42(1), 1971). The weights show this too
    late: in them the velocity counts little. The first rest candidate ends the comparison, and decides itself.
    """
    s.remembers = s.remembers and s.segment.blocks == 0
    if not s.remembers:
        return
    h, prior_var = s.hypotheses, (c.bias_sigma / RAD) ** 2
    slot = max(range(MAX_REMEMBERED), key=lambda index: s.axes[0].remembered[index].weight)
    remembered = [axis.remembered[slot] for axis in s.axes]
    bias_dps = np.array([bias.bias_dps for bias in remembered])
    error_var = np.array([bias.bias_var for bias in remembered]) + MODEL_ERROR**2
    off, spread = np.degrees(h.bias) - bias_dps, h.cov[:, BIAS, BIAS] / RAD**2
    unknown = int(h.knows_bias.argmin())
    jumped = int((h.knows_bias * np.trace(spread, axis1=1, axis2=2)).argmax())
    weight = sum(bias.weight for bias in s.axes[0].remembered)
    prior = (1.0 - weight) * normal_density(bias_dps, np.diag(error_var + prior_var))
    density = normal_density(off[unknown], spread[unknown] + np.diag(error_var))
    if weight * density < prior:
        s.hypotheses, s.remembers = h.select([unknown]), False
        s.hypotheses.weight[0] = 1.0
        return
    mean_var = float(error_var.mean())
    prior = JUMP_SHARE * normal_density(np.zeros(3), np.diag((mean_var, mean_var, mean_var + prior_var)))
    density = normal_density(off[jumped], spread[jumped] + MODEL_ERROR**2 * np.eye(3))
    if len(h.weight) > 2 and (1.0 - JUMP_SHARE) * density < prior:
        s.hypotheses = h.select([unknown, jumped])
        s.hypotheses.weight = np.array((1.0 - weight, JUMP_SHARE * weight)) / (1.0 - weight + JUMP_SHARE * weight)


def in_motion(s: AttitudeState) -> Mask:
    """Hypotheses (n) that know their biases and are not at rest."""
    h = s.hypotheses
    moves: Mask = h.knows_bias & ((h.regime != REST) | (s.segment.blocks == 0))
    return moves


def follow_temperature(s: AttitudeState, seconds: float) -> None:
    """Move the biases of hypotheses in motion along the lines of their axes; `seconds` is the length of the block."""
    if s.temp_c == UNKNOWN_C:
        return
    steps = np.array([follow_line(axis.line, s.temp_c, s.rest_probability, seconds) for axis in s.axes])
    h = s.hypotheses
    is_moving = in_motion(s)
    h.bias[is_moving] += np.radians(steps[:, 0])
    h.cov[is_moving, BIAS, BIAS] += RAD**2 * np.diag(steps[:, 1])
    if s.remembers:
        for axis, (step_dps, more_var) in zip(s.axes, steps.tolist(), strict=True):
            for slot in axis.remembered:
                slot.bias_dps, slot.bias_var = slot.bias_dps + step_dps, slot.bias_var + more_var


def learn_when_sure(c: AttitudeCoefficients, s: AttitudeState, seconds: float) -> None:
    """Keep the biases of a sure rest, and measure their lines every ten seconds of it."""
    is_certain = s.witness.is_believed and s.witness.blocks >= STILL.blocks
    of_axes = zip(s.axes, s.bias_xyz_dps, s.bias_sigma_xyz_dps, strict=True)
    for axis, bias_dps, sigma_dps in of_axes:
        values = (s.rest_probability, bias_dps, sigma_dps * sigma_dps, s.temp_c, s.lived_s)
        if note_sure_rest(axis.sure, *values, seconds, is_certain):
            learn_level(axis.line, axis.sure, seconds, c.walk_var / RAD**2)
