"""Word before the labels of a line: `Gyro: x= 1 | y= 2 | z= 3`, `Setpoint: roll=1 pitch=2 yaw=3`."""

import re

HEADED = re.compile(r"([A-Za-z][\w ()]{0,30}):\s++(?=[A-Za-z]\w{0,7}\s*+[:=])")
WORD = (
    r"(?:info|data|raw|imu\d?|(?:mpu|icm|lsm|bm[ix]|bno)\w*|sensors?|state|meas(?:ured)?|acc\w*|mag\w*"
    r"|att(?:itude)?|angles?|orient(?:ation)?|euler|ypr|rpy|\(\w*\))"
)
PLAIN = re.compile(rf"{WORD}(?: {WORD})*", re.IGNORECASE)
"""Words that do not change the meaning of labels."""

ESP_LOG = re.compile(r"[EWIDV] \(\d{1,12}\) [\w.-]{1,40}:\s++")
"""Head of an ESP-IDF log: level, time and module, which is not a quantity."""

GYRO = re.compile(r"(gyr|rot|omega|ang\w* ?(vel|rate))\w*\b(?! ?(bias|off|std|var|rms|noise))", re.IGNORECASE)
AXIS = re.compile(r"[xyz]|roll|pitch|yaw|[rpy]", re.IGNORECASE)


def head_of(line: str) -> tuple[str, str]:
    """Word before the first label, or empty, and the line without its colon."""
    line = line[log.end() :] if (log := ESP_LOG.match(line)) else line
    match = HEADED.match(line)
    return (match[1].strip(), f"{match[1]} {line[match.end() :]}") if match else ("", line)


def with_head(head: str, labels: tuple[str, ...]) -> tuple[str, ...]:
    """Labels with the head, if it may change their meaning: the yaw of a setpoint is not the yaw."""
    if not head or PLAIN.fullmatch(head):
        return labels
    is_gyro = GYRO.match(head) is not None
    return tuple(
        label if label.startswith(f"{head} ") or (is_gyro and not AXIS.fullmatch(label)) else f"{head} {label}"
        for label in labels
    )
