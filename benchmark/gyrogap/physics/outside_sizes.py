"""Effects that no catalogue has: two sizes of each, the stages that would be a right answer, and what it is."""

from dataclasses import dataclass

from gyrogap.physics.dice import Rng
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.sizes import varied

OUTSIDE_SIZES = ("typical", "large")


@dataclass(frozen=True, slots=True)
class Outside:
    """An effect outside the catalogue.

    strength, sizes
        The parameter that has two sizes.
    rest
        Ranges of the other parameters.
    """

    about: str
    stages: tuple[str, ...]
    strength: str
    sizes: tuple[float, float]
    rest: tuple[tuple[str, float, float], ...] = ()


TURN = ("phase_deg", -180.0, 180.0)

OUTSIDE = {
    "motor_bias": Outside("the bias steps while the motor runs", ("sensor", "platform"), "step_dps", (0.03, 0.15)),
    "direction_memory": Outside(
        "the bias stays where the last motion pushed it", ("sensor", "platform"), "step_dps", (0.02, 0.1)
    ),
    "stress_bias": Outside(
        "the bias jumps at sharp reversals and relaxes over ten seconds",
        ("sensor", "platform"),
        "jump_dps",
        (0.1, 0.5),
        (("relax_s", 7.0, 13.0),),
    ),
    "slow_cycle": Outside(
        "the bias swings with a period of a minute or two",
        ("sensor", "environment"),
        "amplitude_dps",
        (0.012, 0.06),
        (("period_s", 60.0, 150.0),),
    ),
    "cable_twist": Outside(
        "the bias follows the total angle turned", ("platform", "sensor"), "dps_per_turn", (0.005, 0.03)
    ),
    "shake_bias": Outside("any acceleration becomes bias", ("sensor", "platform"), "dps_per_dpss", (5e-5, 2e-4)),
    "temp_hysteresis": Outside(
        "the bias is another one when it warms than when it cools",
        ("environment", "sensor"),
        "dps_per_c",
        (0.02, 0.06),
        (("width_c", 3.0, 5.0),),
    ),
    "ripple": Outside(
        "the bias changes several times per turn",
        ("sensor", "platform"),
        "amplitude_dps",
        (0.02, 0.1),
        (("order", 2.0, 6.99), TURN),
    ),
    "ageing_gain": Outside("the gain drifts during a session", ("sensor", "environment"), "percent", (0.3, 1.5)),
    "turn_on_gain": Outside("every power-on has a gain of its own", ("sensor",), "percent", (0.25, 1.2)),
    "gain_switch": Outside(
        "the gain is another one above a certain rate",
        ("sensor",),
        "percent",
        (0.2, 1.0),
        (("above_dps", 60.0, 110.0),),
    ),
    "rate_noise": Outside("the noise grows with the rate", ("sensor",), "dps_per_dps", (0.0006, 0.002)),
    "noise_bursts": Outside(
        "noise comes in bursts",
        ("sensor",),
        "sigma_dps",
        (0.12, 0.5),
        (("burst_s", 1.5, 4.0), ("every_s", 15.0, 30.0)),
    ),
    "correlated_noise": Outside(
        "more noise, which remembers for tenths of a second",
        ("sensor",),
        "sigma_dps",
        (0.015, 0.05),
        (("memory_s", 0.08, 0.3),),
    ),
    "gliding_tones": Outside(
        "two tones follow the speed of the motor", ("sensor", "platform"), "amplitude_dps", (0.08, 0.4)
    ),
    "missing_codes": Outside(
        "codes of the converter never come", ("sensor",), "gap_dps", (0.2, 0.38), (("every_dps", 0.5, 0.55),)
    ),
    "encoder_harmonic": Outside(
        "the angle errs several times per turn",
        ("encoder", "platform"),
        "amplitude_deg",
        (0.05, 0.3),
        (("order", 2.0, 4.99), TURN),
    ),
    "encoder_delay": Outside(
        "the encoder is read late, so that the rate leads", ("encoder", "sensor", "platform"), "delay_ms", (2.0, 8.0)
    ),
    "clock_steps": Outside(
        "the device clock is set forward now and then", ("clock",), "step_ms", (30.0, 150.0), (("count", 3.0, 6.99),)
    ),
    "host_wander": Outside(
        "the host's clock is pulled to and fro",
        ("clock", "link"),
        "amplitude_ms",
        (15.0, 60.0),
        (("period_s", 120.0, 300.0),),
    ),
    "swapped_rows": Outside("neighbors come in the wrong order", ("link",), "share_percent", (0.1, 1.0)),
    "doubled_rows": Outside("samples come twice", ("link",), "share_percent", (0.1, 1.0)),
}

WHOLE = ("order", "count")
EITHER_WAY = (
    "motor_bias",
    "direction_memory",
    "cable_twist",
    "shake_bias",
    "temp_hysteresis",
    "ageing_gain",
    "gain_switch",
)


def draw_outside(rng: Rng, name: str, size: str) -> InjectedEffect:
    """An effect from OUTSIDE at one of OUTSIDE_SIZES."""
    outside = OUTSIDE[name]
    strength = float(f"{varied(rng, outside.sizes[OUTSIDE_SIZES.index(size)], 1.0):.4g}")
    if name in EITHER_WAY and rng.random() < 0.5:
        strength = -strength
    rest = {key: rng.uniform(low, high) for key, low, high in outside.rest}
    whole = {key: float(int(value)) if key in WHOLE else round(value, 6) for key, value in rest.items()}
    return InjectedEffect(name, {outside.strength: strength, **whole})
