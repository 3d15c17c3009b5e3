"""For MicroPython: the frames of what `asked.json` asks for, `[method, fields]` each; `t_us` comes in one piece.

The sigma of a yaw is null where it is NaN.
"""

import json
import sys

from gyrodrift_native import FrameWriter

writer = FrameWriter()
with open("/asked.json") as request:  # noqa: PTH123 - it has no pathlib
    for method, fields in json.load(request):
        if method in ("sample", "sample3"):
            fields[2] = [fields[2] & 0xFFFF, fields[2] >> 16]
        elif method == "yaw":
            fields[1] = [fields[1] & 0xFFFF, fields[1] >> 16]
            fields[3] = float("nan") if fields[3] is None else fields[3]
        sys.stdout.buffer.write(getattr(writer, method)(*fields))
