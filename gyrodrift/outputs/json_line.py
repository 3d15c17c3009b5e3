"""A corrected sample as a line of JSON: on stdout, and for whoever connects."""

import json
from collections.abc import Callable, Sequence
from typing import Any

from gyrodrift.sample import Corrected

FIELDS: dict[str, Callable[[Corrected], float]] = {
    "seq": lambda c: c.sample.seq,
    "t_s": lambda c: c.sample.t_device_s,
    "t_host_s": lambda c: c.sample.t_host_s,
    "rate_dps": lambda c: c.sample.rate_dps,
    "corrected_dps": lambda c: c.corrected_dps,
    "yaw_deg": lambda c: c.yaw_deg,
    "raw_yaw_deg": lambda c: c.raw_yaw_deg,
    "heading_deg": lambda c: c.heading_deg,
    "bias_dps": lambda c: c.bias_dps,
    "yaw_sigma_deg": lambda c: c.yaw_sigma_deg,
    "bias_sigma_dps": lambda c: c.bias_sigma_dps,
    "rest_probability": lambda c: c.rest_probability,
    "confidence": lambda c: c.confidence,
    "encoder_deg": lambda c: c.sample.encoder_deg,
    "temp_c": lambda c: c.sample.temp_c,
}
"""All that can be asked for, by name."""


def json_line(corrected: Corrected, opening: str = "{") -> str:
    """The line for one sample, every float with all its digits; absent values are left out.

    `opening` is what the object begins with, for a field that all lines have.
    """
    (
        (seq, t_s, _, rate_dps, encoder_deg, temp_c),
        corrected_dps,
        yaw_deg,
        bias_dps,
        yaw_sigma_deg,
        confidence,
        bias_sigma_dps,
        rest_probability,
        _,
        heading_deg,
    ) = corrected
    line = (
        f'{opening}"seq":{seq},"t_s":{t_s!r},"rate_dps":{rate_dps!r},"corrected_dps":{corrected_dps!r},'
        f'"yaw_deg":{yaw_deg!r},"bias_dps":{bias_dps!r}'
    )
    if yaw_sigma_deg == yaw_sigma_deg:  # noqa: PLR0124 - false for NaN alone, and the fastest way to ask
        line += f',"yaw_sigma_deg":{yaw_sigma_deg!r},"confidence":{confidence!r}'
    if bias_sigma_dps == bias_sigma_dps:  # noqa: PLR0124
        line += f',"bias_sigma_dps":{bias_sigma_dps!r},"rest_probability":{rest_probability!r}'
    if heading_deg == heading_deg:  # noqa: PLR0124
        line += f',"heading_deg":{heading_deg!r}'
    if encoder_deg == encoder_deg:  # noqa: PLR0124
        line += f',"encoder_deg":{encoder_deg!r}'
    if temp_c == temp_c:  # noqa: PLR0124
        line += f',"temp_c":{temp_c!r}'
    return line + "}\n"


def chosen_line(corrected: Corrected, names: Sequence[str], **more: Any) -> str:
    """A line with these fields alone, in this order; absent values are left out."""
    values = {name: FIELDS[name](corrected) for name in names}
    return json.dumps(more | {name: value for name, value in values.items() if value == value}) + "\n"  # noqa: PLR0124
