"""A diagnosis of a short session, which compiles what every diagnosis needs."""

from pathlib import Path

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import load_rig
from gyrodrift.cli import main
from gyrodrift.session.files import write_session
from gyrodrift.simulation.sessions import Simulation


def diagnose_in(folder: Path) -> None:
    rig, session, out = folder / "rig.yaml", folder / "session.csv", folder / "out"
    rig.write_text("base: {sample_rate_hz: 20, noise_dps_rthz: 0.0035, bias_dps: 0.35, encoder_cpr: 36000}\n")
    write_session(session, [Simulation(load_rig(rig), load_motion("identify"), 1, minutes=1.0).whole()])
    withheld = [word for name in CATALOGUE for word in ("--withhold", name)]
    words = ["diagnose", str(session), "--rig", str(rig), "--out", str(out), "--jobs", "1", "--quiet", *withheld]
    assert main(words) == 0
