"""The cases in the order of their numbers: 24 flaws, and ten without a gap."""

from dataclasses import dataclass

from simulators import flaws as shared
from simulators.flaws import Flaw
from simulators.unseen import flaws

REAL, SIMULATOR = "real", "simulator"
"""Sides of a case, and names of their folders."""

BOTH_SIDES = (REAL, SIMULATOR)

WORD_DPS = 2000 / 32768
"""Step of 16 bits of 2000 deg/s."""


@dataclass(frozen=True, slots=True)
class UnseenCase:
    """A gap between two sets of sessions of one bench, or none.

    effect, size
        The effect of the catalog that the flaw is (empty without a gap), and how large it is, in words.
    rate_hz, styles, amplitude_dps
        Sample rate; styles of the motion, in any order, and about their largest rate.
    dynamics, readout
        Flaw before or after the noise.
    seconds
        Shortest and longest session.
    real_noise, sim_noise
        White noise, deg/s/√Hz, one-sided; a simulator may have none.
    bias_dps
        Mean bias of the real side; it scatters by 15 %.
    most_hz
        Fastest tone of the motion.
    arrivals, temperatures
        Sides that have arrival times and temperatures.
    range_dps, counts, sim_counts
        Range of 16-bit words of the real side, and counts per turn of both encoders; 0 where nothing is rounded.
    is_powered_on
        Whether sessions begin when the device is powered on, 2 to 5 s before; else its clock begins with them.
    """

    effect: str
    size: str
    bench: str
    rate_hz: float
    styles: tuple[str, ...]
    amplitude_dps: float
    dynamics: Flaw | None = None
    readout: Flaw | None = None
    seconds: tuple[float, float] = (50.0, 75.0)
    real_noise: float = 0.006
    sim_noise: float = 0.006
    bias_dps: float = 0.0
    most_hz: float = 6.0
    arrivals: tuple[str, ...] = ()
    temperatures: tuple[str, ...] = ()
    range_dps: float = 0.0
    counts: int = 0
    sim_counts: int = 0
    is_powered_on: bool = False


# A flaw and all that is not the default stand in lines of their own.
# fmt: off
CASES = (
    UnseenCase("saturation", "140 deg/s", "Drake gimbal", 80.0, ("ramps", "sweep"), 190.0,
               dynamics=shared.limit(140.0), seconds=(45.0, 65.0), bias_dps=0.2, range_dps=500.0),
    UnseenCase("", "ideal simulator", "pymunk rover", 400 / 7, ("sweep", "ramps"), 90.0,
               seconds=(45.0, 60.0), sim_noise=0.0, most_hz=4.0),
    UnseenCase("", "real in 16 bits of 1000 deg/s and 65536 counts", "pymunk shaft", 400 / 6, ("hand", "ramps"), 120.0,
               bias_dps=0.2, range_dps=1000.0, counts=65536),
    UnseenCase("latency", "15 ms", "Drake table", 80.0, ("hand", "rock"), 120.0,
               dynamics=flaws.all_pass(0.015), seconds=(45.0, 65.0), bias_dps=0.4, range_dps=250.0),
    UnseenCase("bandwidth", "Bessel of second order, 5 Hz at -3 dB", "pymunk rover", 80.0, ("sweep", "rock", "hand"),
               100.0,
               dynamics=flaws.bessel_filter(5.0), seconds=(50.0, 65.0), sim_noise=0.0),
    UnseenCase("spikes", "0.4 %, normal of 26 deg/s", "Drake torso", 50.0, ("mission", "scan", "rock"), 80.0,
               readout=flaws.impulses(26.0, 0.4), seconds=(50.0, 70.0)),
    UnseenCase("deadband", "reads 0 from below 0.28 until above 0.36 deg/s", "Drake gimbal", 80.0,
               ("scan", "hand", "ramps"), 90.0,
               readout=flaws.dead_band(0.28, 0.36), seconds=(60.0, 75.0), bias_dps=0.05),
    UnseenCase("", "plain, 40 Hz", "pymunk shaft", 40.0, ("rock", "sweep"), 110.0,
               bias_dps=0.8, most_hz=3.0),
    UnseenCase("encoder_slip", "2.6 deg each 18 s of motion", "pymunk rover", 50.0, ("rock", "ramps"), 100.0,
               dynamics=flaws.skipped_teeth(2.6, 18.0), seconds=(60.0, 75.0), arrivals=(REAL,)),
    UnseenCase("", "temperatures of the real side only", "pymunk rover", 40.0, ("hand", "scan"), 80.0,
               seconds=(60.0, 75.0), bias_dps=0.3, temperatures=(REAL,)),
    UnseenCase("temp_scale", "0.06 %/K", "Drake gimbal", 400 / 7, ("ramps", "turns"), 130.0,
               dynamics=flaws.temperature_gain(0.06), seconds=(65.0, 75.0), real_noise=0.005, sim_noise=0.005,
               temperatures=BOTH_SIDES),
    UnseenCase("quantization", "0.2 deg/s, rounded", "pymunk rover", 80.0, ("rock", "hand", "scan"), 90.0,
               readout=flaws.rounded(0.2), bias_dps=0.07),
    UnseenCase("vibration_rectification", "0.16 deg/s at 100 deg/s", "Drake table", 80.0, ("ramps", "rock", "turns"),
               190.0,
               dynamics=shared.square(0.16), bias_dps=0.2),
    UnseenCase("scale_factor", "-1.2 %", "Drake torso", 80.0, ("rock", "mission"), 90.0,
               dynamics=shared.gain(-1.2), real_noise=0.008, sim_noise=0.008, bias_dps=0.3),
    UnseenCase("", "arrivals and temperatures of both sides", "Drake gimbal", 50.0, ("turns", "rock"), 110.0,
               seconds=(60.0, 75.0), arrivals=BOTH_SIDES, temperatures=BOTH_SIDES),
    UnseenCase("", "plain, noise of the simulator is larger", "Drake table", 400 / 7, ("ramps", "hand", "scan"), 100.0,
               real_noise=0.004, sim_noise=0.014, bias_dps=0.1),
    UnseenCase("", "ideal simulator", "Drake gimbal", 80.0, ("rock", "hand"), 100.0,
               real_noise=0.008, sim_noise=0.0, bias_dps=0.2),
    UnseenCase("", "arrivals of the real side only", "Drake table", 80.0, ("rock", "mission"), 110.0,
               arrivals=(REAL,)),
    UnseenCase("", "real in steps of 0.061 deg/s, noise of 0.8 steps", "Drake torso", 100.0, ("rock", "scan"), 90.0,
               real_noise=0.8 * WORD_DPS / 50**0.5, sim_noise=0.8 * WORD_DPS / 50**0.5, bias_dps=0.4,
               range_dps=2000.0),
    UnseenCase("popcorn", "0.2 deg/s, 11 s and 8 s, Markov", "Drake table", 400 / 6, ("hand", "scan"), 90.0,
               dynamics=flaws.telegraph(0.2, 11.0, 8.0), seconds=(65.0, 75.0)),
    UnseenCase("encoder_eccentricity", "0.55 deg, second harmonic of a tenth", "Drake gimbal", 80.0,
               ("turns", "ramps"), 110.0,
               dynamics=flaws.eccentric(0.55, 75.0, 0.1), seconds=(60.0, 75.0), sim_noise=0.0),
    UnseenCase("nonlinearity", "1.9 % lost at 250 deg/s", "pymunk shaft", 80.0, ("ramps", "rock"), 235.0,
               dynamics=flaws.sine_response(0.019), sim_noise=0.0, most_hz=5.0),
    UnseenCase("warmup", "0.6 deg/s, 32 s, one exponential", "Drake table", 40.0, ("scan", "mission"), 100.0,
               dynamics=flaws.exponential_warm_up(0.6, 32.0), seconds=(65.0, 75.0), bias_dps=0.1, is_powered_on=True),
    UnseenCase("rate_random_walk", "0.018 deg/s/sqrt(s)", "Drake torso", 80.0, ("ramps", "mission"), 80.0,
               dynamics=flaws.wiener(0.018), seconds=(70.0, 75.0), real_noise=0.004, sim_noise=0.0),
    UnseenCase("", "ideal simulator", "Drake torso", 400 / 6, ("ramps", "scan", "mission"), 80.0,
               sim_noise=0.0, bias_dps=0.5),
    UnseenCase("vibration", "0.34 deg/s at 21.5 Hz", "pymunk shaft", 80.0, ("ramps", "hand"), 100.0,
               dynamics=flaws.swelling_tone(0.34, 21.5), seconds=(45.0, 65.0), arrivals=(SIMULATOR,)),
    UnseenCase("backlash", "0.3 deg", "pymunk shaft", 80.0, ("rock", "scan", "hand"), 100.0,
               dynamics=shared.gear_play(0.3), seconds=(50.0, 70.0), bias_dps=0.1),
    UnseenCase("scale_asymmetry", "0.62 %", "Drake torso", 80.0, ("ramps", "mission"), 90.0,
               dynamics=shared.direction_gain(0.62), bias_dps=0.2),
    UnseenCase("bias_instability", "270 deg/h", "Drake gimbal", 400 / 6, ("scan", "ramps"), 80.0,
               dynamics=flaws.voss(270.0), seconds=(70.0, 75.0), real_noise=0.003, sim_noise=0.003),
    UnseenCase("deadband", "below 0.5 deg/s reads 0", "pymunk shaft", 40.0, ("scan", "rock"), 70.0,
               readout=flaws.dead_band(0.5, 0.5), seconds=(50.0, 70.0)),
    UnseenCase("temp_bias", "0.04 deg/s/K, grows by exp(dT/60)", "pymunk rover", 40.0, ("rock", "mission"), 90.0,
               dynamics=flaws.temperature_bias(0.04), seconds=(65.0, 75.0), bias_dps=0.2, temperatures=BOTH_SIDES),
    UnseenCase("bandwidth", "first order, 5.2 Hz", "pymunk shaft", 400 / 6, ("sweep", "ramps"), 110.0,
               dynamics=flaws.one_pole(5.2), seconds=(45.0, 60.0), real_noise=0.008, sim_noise=0.008, most_hz=8.0),
    UnseenCase("encoder_quantization", "256 counts per turn, the simulator 4096", "Drake torso", 80.0,
               ("scan", "ramps", "hand"), 80.0,
               readout=shared.coarse_encoder(256), seconds=(50.0, 70.0), sim_counts=4096),
    UnseenCase("g_sensitivity", "0.14 deg/s once per turn, second harmonic of 8 %", "Drake table", 40.0,
               ("turns", "rock"), 120.0,
               dynamics=flaws.gravity(0.14, -35.0, 0.08), seconds=(60.0, 75.0), arrivals=BOTH_SIDES),
)
# fmt: on
