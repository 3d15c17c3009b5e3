"""Effects of one axis: stages, groups that look similar, and the parameter that a fit is judged by."""

EFFECTS_OF_STAGE = {
    "sensor": (
        "scale_factor",
        "scale_asymmetry",
        "nonlinearity",
        "deadband",
        "saturation",
        "quantization",
        "bandwidth",
        "latency",
        "bias_instability",
        "rate_random_walk",
        "popcorn",
        "spikes",
        "vibration",
        "vibration_rectification",
        "g_sensitivity",
    ),
    "environment": ("temp_bias", "temp_scale", "warmup"),
    "platform": ("backlash",),
    "encoder": ("encoder_eccentricity", "encoder_slip", "encoder_quantization"),
    "clock": ("clock_drift", "timestamp_jitter"),
    "link": ("usb_batching", "sample_drop", "stale_hold"),
}
EFFECTS = tuple(effect for effects in EFFECTS_OF_STAGE.values() for effect in effects)
STAGE = {effect: stage for stage, effects in EFFECTS_OF_STAGE.items() for effect in effects}

GROUPS = {
    "slow bias": ("temp_bias", "warmup"),
    "lag": ("bandwidth", "latency"),
    "stochastic bias": ("bias_instability", "rate_random_walk", "popcorn"),
    "even in rate": ("scale_asymmetry", "vibration_rectification"),
    "once per turn": ("g_sensitivity", "encoder_eccentricity"),
    "times": ("timestamp_jitter", "usb_batching"),
    "coarse values": ("deadband", "quantization", "stale_hold"),
    "outliers": ("spikes", "encoder_slip"),
}
"""Effects that look similar, by group. All sessions have host times; some have a warm start or are heated. So a clock
does not look like a scale error. An effect without a group is a group of its own."""

GROUP = {effect: effect for effect in EFFECTS} | {
    effect: group for group, members in GROUPS.items() for effect in members
}

JUDGED = {
    "scale_factor": "error_percent",
    "scale_asymmetry": "error_percent",
    "deadband": "width_dps",
    "saturation": "limit_dps",
    "quantization": "step_dps",
    "latency": "delay_ms",
    "bias_instability": "floor_dph",
    "rate_random_walk": "density_dps_rts",
    "popcorn": "step_dps",
    "spikes": "height_dps",
    "vibration": "amplitude_dps",
    "vibration_rectification": "bias_dps_at_100_dps",
    "g_sensitivity": "amplitude_dps",
    "temp_scale": "slope_percent_per_c",
    "backlash": "play_deg",
    "encoder_eccentricity": "amplitude_deg",
    "encoder_slip": "step_deg",
    "encoder_quantization": "cpr",
    "clock_drift": "ppm",
    "timestamp_jitter": "sigma_ms",
    "usb_batching": "interval_ms",
    "sample_drop": "share_percent",
    "stale_hold": "share_percent",
}
"""The strength by which a fit is judged. Four effects have another form here than in the simulator, so that no value
of a parameter is true: the cubic (a tanh beside a straight path), the low-pass (second order), the bias by temperature
(quadratic) and the warm-up (two exponentials)."""
