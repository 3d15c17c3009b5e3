"""The word before the labels of a line: `Gyro: x= 1 | y= 2 | z= 3`, `Setpoint: roll=1 pitch=2 yaw=3`."""

import re

HEADED = re.compile(r"([A-Za-z][\w ()]{0,30}):\s++(?=[A-Za-z]\w{0,7}\s*+[:=])")
WORD = (
    r"(?:info|data|raw|imu\d?|(?:mpu|icm|lsm|bm[ix]|bno)\w*|sensors?|state|meas(?:ured)?|acc\w*|mag\w*"
    r"|att(?:itude)?|angles?|orient(?:ation)?|euler|ypr|rpy|\(\w*\))"
)
PLAIN = re.compile(rf"{WORD}(?: {WORD})*", re.IGNORECASE)
"""Words that leave each label what it is alone."""

ESP_LOG = re.compile(r"[EWIDV] \(\d{1,12}\) [\w.-]{1,40}:\s++")
"""The head of a log of ESP-IDF: level, time and the part of the program, which names no quantity."""

GYRO = re.compile(r"(gyr|rot|omega|ang\w* ?(vel|rate))\w*\b(?! ?(bias|off|std|var|rms|noise))", re.IGNORECASE)
AXIS = re.compile(r"[xyz]|roll|pitch|yaw|[rpy]", re.IGNORECASE)


def head_of(line: str) -> tuple[str, str]:
    """The word before the first label, empty where none is, and the line with its colon taken off."""
    line = line[log.end() :] if (log := ESP_LOG.match(line)) else line
    found = HEADED.match(line)
    return (found[1].strip(), f"{found[1]} {line[found.end() :]}") if found else ("", line)


def with_head(head: str, labels: tuple[str, ...]) -> tuple[str, ...]:
    """The labels, each behind the head where that may change what they mean: the yaw of a setpoint is not the yaw."""
    if not head or PLAIN.fullmatch(head):
        return labels
    is_gyro = GYRO.match(head) is not None
    return tuple(
        label if label.startswith(f"{head} ") or (is_gyro and not AXIS.fullmatch(label)) else f"{head} {label}"
        for label in labels
    )
