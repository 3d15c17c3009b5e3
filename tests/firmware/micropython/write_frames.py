"""For MicroPython: the frames of what `asked.json` asks for, `[method, fields]` each; `t_us` comes in one piece."""

import json
import sys

from gyrodrift_native import FrameWriter

writer = FrameWriter()
with open("/asked.json") as asked:  # noqa: PTH123 - it has no pathlib
    for method, fields in json.load(asked):
        if method in ("sample", "sample3"):
            fields[2] = [fields[2] & 0xFFFF, fields[2] >> 16]
        sys.stdout.buffer.write(getattr(writer, method)(*fields))
