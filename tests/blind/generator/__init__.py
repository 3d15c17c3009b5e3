"""Sessions and a rig file from a recipe: the physics of a gyro on a turntable, a second time, by other means.

It imports nothing of gyrodrift and nothing of its simulator (a test holds that): numpy and scipy alone.

    dice.py          random numbers for one purpose
    motion.py        what a motor does, as rates on a grid of at least 800 Hz
    sessions.py      which sessions a case has: how long, cold or warm, heated or not
    scene.py         the truth of one session
    device.py        the real device, and the rig file that knows it only roughly
    sensor_*.py, environment.py, reference.py, link.py    the effects of the catalogue, in forms of their own
    outside_*.py     effects that are in no catalogue
    kinds.py         every effect by name and place
    bench.py         scene → measurements
    sizes.py         how large an effect is
    pairs.py, recipes.py    which cases a set has
    write.py         a case as files
"""
