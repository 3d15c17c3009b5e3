"""The table of fields: every value of a corrected sample that an output can send, in one record each.

An output takes the fields of its use (`fields_of`) and adds only what its protocol alone has. A record without `uses`
goes to all outputs whose messages can have any field. The order is that of `HELLO` and of objects with all fields.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Flag, auto
from functools import cached_property
from math import nan
from operator import attrgetter
from typing import Any

from gyrodrift.values.sample import Corrected

Value = float | tuple[float, ...]


class Use(Flag):
    """Receivers of a field."""

    CHOICE = auto()
    """Clients of `tcp` and `unix` may choose it; `udp`, `mqtt`, `gpsd` and `foxglove` send it."""
    LINE = auto()
    """JSON lines."""
    STATUS = auto()
    """`ctl status`, the gauges of `prometheus`, the state of `foxglove`."""
    SENSOR = auto()
    """Sensors of Home Assistant."""
    TOPIC = auto()
    """Topics of `networktables`."""
    POINT = auto()
    """Points of the live page."""
    SPAN = auto()
    """Minimum and maximum in points of the live page."""
    FIGURE = auto()
    """Lines of `top`, which has longer lines for other fields."""


EACH_LINE = Use.CHOICE | Use.LINE
MEASURED = EACH_LINE | Use.SENSOR | Use.TOPIC | Use.POINT
ESTIMATED = MEASURED | Use.STATUS
ESTIMATED_SPAN = ESTIMATED | Use.SPAN
COMPARED = EACH_LINE | Use.STATUS | Use.POINT

UNITS = {"deg": "deg", "dps": "deg/s", "c": "°C", "s": "s"}
"""Units by the end of a name."""

DECIMALS = {"deg": 4, "deg/s": 5, "°C": 2, "s": 6, "": 4}
"""Digits behind the point by unit. Device clocks count microseconds. 1e-5 deg/s is 0.036 deg/h, below the bias
instability of any such gyro. 1e-4 deg is one of 3.6 million counts, finer than encoders of turntables. Recordings keep
all digits."""


@dataclass(frozen=True)
class Field:
    """A value of a corrected sample.

    name
        Key in JSON; it ends with the unit.
    source
        Attribute of `Corrected`; several words behind the last point make a list.
    description
        What it is, in one sentence.
    title, shown
        Name for people, and the decimals that they see.
    """

    name: str
    source: str
    description: str
    title: str = ""
    shown: int = 0
    uses: Use = ESTIMATED | Use.FIGURE

    @property
    def unit(self) -> str:
        """Unit; empty for a number without one."""
        return UNITS.get(self.name.rpartition("_")[2], "")

    @property
    def decimals(self) -> int:
        """Digits behind the point in JSON."""
        return {"seq": 0, "corrections": 0, "q": 6}.get(self.name, DECIMALS[self.unit])

    @property
    def count(self) -> int:
        """Length of a list, or 1."""
        return len(self.source.split())

    @property
    def is_list(self) -> bool:
        """Whether it has several numbers."""
        return self.count > 1

    @cached_property
    def value(self) -> Callable[[Corrected], Value | None]:
        """Gives the value in a sample: None if the device has none, NaN if it is unknown."""
        holder, _, names = self.source.rpartition(".")
        get: Callable[[Any], Value] = attrgetter(*names.split())
        if not holder:
            return get
        holder_of = attrgetter(holder)
        return lambda corrected: None if (record := holder_of(corrected)) is None else get(record)

    @cached_property
    def number(self) -> Callable[[Corrected], float]:
        """Gives the value in a sample, of a field that is no list: NaN if the device has none, or it is unknown."""
        value: Callable[[Corrected], Any] = self.value
        return value if "." not in self.source else lambda corrected: nan if (it := value(corrected)) is None else it


OF_EVERY_DEVICE = (
    Field("seq", "sample.seq", "Counter of the samples.", uses=EACH_LINE),
    Field("t_s", "sample.t_device_s", "Device clock.", uses=EACH_LINE),
    Field("t_host_s", "sample.t_host_s", "Arrival, Unix time.", uses=Use.CHOICE),
    Field("rate_dps", "sample.rate_dps", "Measured rate.", uses=EACH_LINE | Use.POINT | Use.SPAN),
    Field("corrected_dps", "corrected_dps", "Measured rate without the bias.", "Yaw rate", 3, MEASURED),
    Field("yaw_deg", "yaw_deg", "Unwrapped yaw, counter-clockwise.", "Yaw", 2, ESTIMATED_SPAN),
    Field("raw_yaw_deg", "raw_yaw_deg", "Integral of the measured rate.", uses=Use.CHOICE | Use.POINT | Use.SPAN),
    Field("heading_deg", "heading_deg", "Compass heading, clockwise, 0 to 360.", "Heading", 1, ESTIMATED),
    Field("bias_dps", "bias_dps", "Bias estimate.", "Drift estimate", 5, ESTIMATED),
    Field("yaw_sigma_deg", "yaw_sigma_deg", "Standard deviation of yaw.", "Yaw uncertainty", 3, ESTIMATED),
    Field(
        "bias_sigma_dps",
        "bias_sigma_dps",
        "Standard deviation of the bias estimate.",
        "Drift uncertainty",
        5,
        ESTIMATED & ~Use.TOPIC,
    ),
    Field(
        "rest_probability",
        "rest_probability",
        "Probability of rest.",
        "Rest probability",
        2,
        ESTIMATED_SPAN & ~Use.TOPIC,
    ),
    Field(
        "confidence",
        "confidence",
        "Probability of the most probable hypothesis of the filter.",
        uses=EACH_LINE | Use.STATUS,
    ),
    Field("correction_deg", "correction_deg", "Step of yaw in this sample that is no motion, 0 else.", uses=EACH_LINE),
    Field("corrections", "corrections", "Number of corrections over 1 deg.", uses=EACH_LINE | Use.STATUS),
    Field("smooth_yaw_deg", "smooth_yaw_deg", "Yaw that takes corrections in slowly.", uses=EACH_LINE | Use.STATUS),
    Field("encoder_deg", "sample.encoder_deg", "Angle of the encoder.", uses=EACH_LINE),
    Field("temp_c", "sample.temp_c", "Temperature of the sensor.", "Temperature", 1),
)
"""Fields that any device can have."""

OF_THREE_AXES = (
    Field("q", "attitude.q_w q_x q_y q_z", "Rotation from the sensor to the earth frame.", uses=EACH_LINE),
    Field("tilt_deg", "attitude.tilt_deg", "Angle between the up axis and the vertical.", "Tilt", 1, ESTIMATED),
    Field("roll_deg", "attitude.roll_deg", "Roll, positive with the right side down.", "Roll", 1, ESTIMATED_SPAN),
    Field("pitch_deg", "attitude.pitch_deg", "Pitch, positive with the nose down.", "Pitch", 1, ESTIMATED_SPAN),
    Field(
        "tilt_sigma_deg", "attitude.tilt_sigma_deg", "Standard deviation of the tilt.", "Tilt uncertainty", 2, ESTIMATED
    ),
    Field("bias_xyz_dps", "attitude.bias_x_dps bias_y_dps bias_z_dps", "Bias estimate by axis.", uses=EACH_LINE),
)
"""Further fields of a device with three axes, in the order of `Attitude`; they are there with the attitude."""

OF_OWN_FILTER = (
    Field("device_yaw_deg", "sample.device_yaw.yaw_deg", "Yaw of the filter in the device.", uses=COMPARED),
    Field(
        "device_yaw_sigma_deg",
        "sample.device_yaw.yaw_sigma_deg",
        "Standard deviation of the yaw in the device.",
        uses=COMPARED,
    ),
    Field(
        "device_bias_dps",
        "sample.device_yaw.bias_dps",
        "Bias estimate of the filter in the device.",
        uses=EACH_LINE | Use.STATUS,
    ),
    Field(
        "device_difference_deg",
        "device_difference_deg",
        "Yaw minus that of the device since the start.",
        uses=Use.STATUS | Use.POINT | Use.SPAN,
    ),
)
"""Further fields of a device that runs a filter itself."""

FIELDS = OF_EVERY_DEVICE + OF_THREE_AXES + OF_OWN_FILTER


def fields_of(use: Use, *tables: tuple[Field, ...]) -> tuple[Field, ...]:
    """Fields of a use, of these tables or of all."""
    return tuple(field for table in tables or (FIELDS,) for field in table if use in field.uses)


CHOICES = {field.name: field for field in fields_of(Use.CHOICE)}
"""Fields that clients can choose, by name."""
