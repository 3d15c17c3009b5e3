"""A method that opens no recording: it reads `simulator.yaml` alone. What it scores above chance is a leak.

An effect of the simulator gets another size, as far away as typical and large are apart. The answer is `none` for a
simulator without an effect.
"""

from gyrogap.catalogue import JUDGED
from gyrogap.physics.sizes import STRENGTHS

from evaluate.gyrogap_methods.cases import Answer, PublicCase


def answer(case: PublicCase) -> Answer:
    """The first judged effect that the simulator has, at a larger size if its own is small, otherwise at a smaller."""
    stated = [effect for effect in case.simulator["effects"] if effect["name"] in JUDGED]
    if not stated:
        return {"causes": [], "none": 1.0, "unknown": 0.0}
    first, *_ = stated
    parameter = JUDGED[first["name"]]
    _, typical, large = STRENGTHS[first["name"]].sizes
    size, ratio = abs(first[parameter]), large / typical
    is_smaller = abs(size / typical - 1.0) < abs(size / large - 1.0)
    changed_size = first[parameter] * (ratio if is_smaller else 1.0 / ratio)
    cause = {"effect": first["name"], "probability": 0.6, "parameters": {parameter: changed_size}}
    return {"causes": [cause], "none": 0.4, "unknown": 0.0}
