"""For MicroPython: a filter over the samples of `asked.json`; yaw, sigma and bias after each, and the heap it takes."""

import gc
import json
import sys
import time

if not hasattr(time, "ticks_diff"):
    raise RuntimeError("this port has no ticks_diff")

with open("/asked.json") as request:  # noqa: PTH123 - it has no pathlib
    REQUEST = json.load(request)

gc.collect()
before = gc.mem_alloc()
if REQUEST["filter"] == "hdr":
    from gyrodrift_hdr import Hdr as Filter
else:
    from gyrodrift_restlevel import Restlevel as Filter
gc.collect()
loaded = gc.mem_alloc()
chosen = Filter(**REQUEST["params"])
gc.collect()
made = gc.mem_alloc()

update = chosen.update_us if REQUEST["clock"] == "us" else chosen.update
rows = []
for t, *values in REQUEST["samples"]:
    is_taken = update(t, *[float("nan") if value is None else value for value in values])
    rows.append([bool(is_taken), chosen.yaw_deg, getattr(chosen, "yaw_sigma_deg", None), chosen.bias_dps])

gc.collect()
gc.disable()
dt = 10_000 if REQUEST["clock"] == "us" else 0.01
t += dt
update(t, 0.25)
start = gc.mem_alloc()
for _ in range(10):
    t += dt
    update(t, 0.25)
taken = gc.mem_alloc() - start
sys.stdout.write(json.dumps({"rows": rows, "module": loaded - before, "state": made - loaded, "sample": taken / 10}))
