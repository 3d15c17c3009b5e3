"""The program that people write first: readline, split, filter, print. What `serve` is measured against."""

import json
import sys

import serial

from gyrodrift.filters.hdr import HdrParams, HdrState, coefficients, step


def main(port: str, count: int) -> None:
    """Print `count` corrected samples of a device that speaks csv."""
    device = serial.Serial(port, 115200, timeout=1.0)
    table, state = coefficients(HdrParams()), HdrState()
    for seq in range(count):
        t_us, rate_dps, encoder_deg, temp_c = map(float, device.readline().split(b","))
        step(table, state, t_us * 1e-6, rate_dps)
        line = {
            "seq": seq,
            "t_s": t_us * 1e-6,
            "rate_dps": rate_dps,
            "corrected_dps": rate_dps + state.i_dps,
            "yaw_deg": state.yaw_deg,
            "bias_dps": -state.i_dps,
            "encoder_deg": encoder_deg,
            "temp_c": temp_c,
        }
        print(json.dumps(line))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
