"""Bytes behind the last whole record, which may hold a password."""

from pathlib import Path

import pytest

from gyrodrift.session.mcap import repair
from gyrodrift.session.mcap.repair import covered, keep_tail

TEXTS = (
    b"outputs: [{name: mqtt, password: hunter2}]",
    b"# hunter2\noutputs:\n  - {name: mqtt, API_KEY: x}\n# hunter2",
    b"port: mqtt://ann:hunter2@broker/topic",
    b"password: |\n  hunter2\n",
    "ключ hunter2, token: 5".encode(),
)


@pytest.mark.promise("Secrets")
@pytest.mark.parametrize("text", TEXTS)
def test_a_text_that_mentions_a_secret_is_covered_whole(text: bytes) -> None:
    """A text of a cut-off file that mentions a secret is covered completely."""
    before, behind = b"\x00\x01rate\x02", b"\x00note: none\x03"
    assert covered(before + text + behind) == before + b"*" * len(text) + behind


def test_text_without_a_secret_stays() -> None:
    """Lines of a device, and the name of a file with a password."""
    content = b"\x00t_us,rate_dps\n1000,0.5\npassword_file: /etc/p\x00"
    assert covered(content) == content


@pytest.mark.parametrize("block_bytes", [7, 64, 1000])
def test_a_secret_across_blocks_is_covered(tmp_path: Path, block_bytes: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files are copied piece by piece."""
    content = b"\x00" * 40 + b"password: " + b"hunter2 " * 50 + b"\x00" * 40
    path = tmp_path / "s.mcap"
    path.write_bytes(content)
    pieces = [(index, content[index : index + block_bytes]) for index in range(0, len(content), block_bytes)]
    monkeypatch.setattr(repair, "data_blocks", lambda *_: iter(pieces))
    with path.open("rb") as file:
        saved = keep_tail(path, file, 0, len(content))
    assert saved.read_bytes() == covered(content)
    assert b"hunter2" not in saved.read_bytes()
