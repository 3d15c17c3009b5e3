"""Sessions and a rig file from drawn values: the physics of a gyro on a turntable, written a second time.

It imports nothing of gyrodrift beside its own package, and nothing of its simulator: numpy and scipy alone. A test
checks this. Read the modules in this order:

- `dice`: random numbers for one purpose.
- `motion`, `driven`: rates of a motor, a robot, a hand or a drone on a grid of at least 800 Hz.
- `sessions`: length, start and temperature of each session.
- `scene`: the truth of one session.
- `device`, `spread`: a real device, and the rig file that knows it roughly.
- `sensor_*`, `environment`, `reference`, `link`: the effects of the catalogue.
- `outside_*`: effects that are in no catalogue.
- `kinds`: all effects by name.
- `bench`: measurements from a scene.
- `sizes`, `pairs`: sizes of effects, and pairs of them.
- `rig_text`, `write`: files.
"""
