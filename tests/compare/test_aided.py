"""Sessions with second sources: `compare` with and without them, `doctor`, and the check at the end of `tune`."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gyrodrift.compare.methods.filter_method import AIDED
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.doctor.checks.aids import sources_of
from gyrodrift.doctor.checks.registry import examine
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import Severity
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session
from gyrodrift.values.aid import Aid

BIAS_DPS = 0.3


@pytest.fixture
def session() -> Session:
    """A device that swings for a minute, with a bias, an encoder and a heading each second."""
    t_s = 0.02 * np.arange(3000)
    angle_deg = 30.0 * np.sin(0.7 * t_s)
    noise_dps = np.random.default_rng(1).normal(0.0, 0.05, len(t_s))
    aids = tuple((row, Aid("camera", "heading", float(angle_deg[row]), sigma=1.0)) for row in range(0, 3000, 50))
    rate_dps = 21.0 * np.cos(0.7 * t_s) + BIAS_DPS + noise_dps
    return Session(
        "swing",
        np.asarray(t_s, dtype=np.float64),
        np.asarray(rate_dps, dtype=np.float64),
        encoder_deg=angle_deg,
        aids=aids,
    )


def test_the_row_with_second_sources_is_better(session: Session, tmp_path: Path) -> None:
    path = tmp_path / "swing.mcap"
    write_session(path, [session])
    loaded = load_with_reference(Source(path))
    reference = loaded.reference
    assert reference.aids is not None
    assert len(reference.aids) == 60
    errors_deg = []
    for key in ("restlevel", AIDED.key):
        method = by_key()[key].on(None, reference.auxiliary, None, reference.aids)
        yaw_deg = method.run(loaded.t_s, reference.rate_dps, method.defaults)
        errors_deg.append(float(np.abs(yaw_deg - reference.reference_deg).mean()))
    assert errors_deg[1] < min(2.0, 0.5 * errors_deg[0])


def test_doctor_says_whether_they_agree(session: Session) -> None:
    findings = {finding.id: finding for finding in examine(DeviceEvidence("s", facts=SessionFacts(session)))}
    assert findings["second_sources"].says.startswith("The second sources agree with the gyro: camera")
    backwards = tuple((row, aid._replace(value=-aid.value)) for row, aid in session.aids or ())
    sources = sources_of(replace(session, aids=backwards))
    assert sources is not None
    assert sources["camera"].differs
    (finding,) = [
        finding
        for finding in examine(DeviceEvidence("s", facts=SessionFacts(replace(session, aids=backwards))))
        if finding.id == "second_sources"
    ]
    assert finding.severity is Severity.WARNING
