"""A secret is shown to nobody: the type, text that names passwords, and the text of a config."""

import copy
import json
import pickle

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.io.public_yaml import NOT_KEPT, public_yaml
from gyrodrift.values.errors import GyrodriftError
from gyrodrift.values.secret import SecretText, is_secret_name, shown_key, shown_words, without_secrets

MARKER = "Marker7"


def test_a_secret_shows_itself_to_nobody_but_who_asks() -> None:
    """Printed, formatted, as JSON with a default, and in a container."""
    secret = SecretText(MARKER)
    shown = [f"{secret} {secret!r} {secret!s}", str([secret]), json.dumps({"p": secret}, default=str)]
    assert all(MARKER not in text and "***" in text for text in shown)
    assert (secret.reveal(), bool(secret), bool(SecretText())) == (MARKER, True, False)
    assert (secret, hash(secret)) == (copy.deepcopy(secret), hash(SecretText(MARKER)))
    assert pickle.loads(pickle.dumps(secret)) != SecretText("another")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        (f"--output mqtt:user=ann,password={MARKER},port=1 is wrong", "--output mqtt:user=ann,password=*** is wrong"),
        (f"password: {MARKER}", "password: ***"),
        (f'{{"token": "{MARKER} {MARKER}", "n": 1}}', '{"token": ***, "n": 1}'),
        (f"api_key='{MARKER}' next", "api_key=*** next"),
        (f"mqtt://ann:{MARKER}@broker/topic", "mqtt://ann:***@broker/topic"),
        (f"mqtt://ann:a@{MARKER}/b@broker:1883", "mqtt://ann:***@broker:1883"),
        (f"mqtt://:{MARKER}@[::1]:1", "mqtt://:***@[::1]:1"),
        ("password_file=/etc/p, http://host:80/path is fine", "password_file=/etc/p, http://host:80/path is fine"),
        ("a token of thanks", "a token of thanks"),
        ("/dev/token: this is not a serial port", "/dev/token: this is not a serial port"),
        ("secret: there is no such port", "secret: there is no such port"),
        ("outputs.0.password: is not shown; expected text", "outputs.0.password: is not shown; expected text"),
    ],
)
def test_a_message_names_no_secret(text: str, shown: str) -> None:
    assert without_secrets(text) == shown
    assert str(GyrodriftError(text)) == shown


def test_a_command_line_is_shown_without_secrets() -> None:
    words = ["serve", "--output", f"mqtt:user=ann,password=a, b {MARKER}", "--port", f"mqtt://a:{MARKER}@b/c"]
    assert shown_words(words) == ["serve", "--output", "mqtt:user=ann,password=***", "--port", "mqtt://a:***@b/c"]


def test_names_of_secrets_are_known() -> None:
    """A file with a password is no secret itself."""
    assert all(
        map(is_secret_name, ["password", "Password", "mqtt_password", "api_key", "apikey", "auth_token", "pass"])
    )
    assert not any(map(is_secret_name, ["password_file", "key", "user", "passes", "topic", "token_path"]))
    assert [shown_key("password:abc"), shown_key("port"), shown_key("a=b")] == ["password…", "port", "a…"]


CONFIG = """\
filter: hdr  # of the {marker} bench
outputs:
  - {{name: mqtt, user: ann, password: {password}, port: 1}}
  # password: {marker}
  - name: tcp
hdr: {{tau_s: 1e-3}}
"""


@pytest.mark.promise("Secrets")
@pytest.mark.parametrize(
    "password",
    [
        MARKER,
        f'"{MARKER} , }}"',
        f"'{MARKER}\n\n     {MARKER}'",
        f"&{MARKER} {MARKER}",
        f"!{MARKER} {MARKER}",
        f"[{MARKER}, {{a: {MARKER}}}]",
        f"{{{MARKER}: {MARKER}}}",
        f"? {MARKER}",
        f"*{MARKER}",
    ],
)
def test_a_config_is_kept_without_its_secrets_and_comments(password: str) -> None:
    """A recording keeps the config without secrets and comments."""
    kept = public_yaml(CONFIG.format(marker=MARKER, password=password))
    assert MARKER not in kept
    if kept != NOT_KEPT:
        mqtt = {"name": "mqtt", "user": "ann", "password": "***", "port": 1}
        read = yaml.safe_load(kept)
        assert read == {"filter": "hdr", "outputs": [mqtt, {"name": "tcp"}], "hdr": {"tau_s": "1e-3"}}


@pytest.mark.parametrize("style", ["|", ">", "|-", ">+"])
def test_a_password_of_several_lines_goes_whole(style: str) -> None:
    """A block scalar ends where its indentation does."""
    text = f"password: {style}\n  {MARKER}\n\n  # {MARKER}\nport: 1\n"
    kept = public_yaml(text)
    assert (MARKER in kept, yaml.safe_load(kept)) == (False, {"password": "***", "port": 1})


def test_a_config_without_secrets_is_kept_to_the_letter() -> None:
    text = "# my bench\noutputs: [{name: mqtt, password_file: /etc/p}]  # why\n"
    assert public_yaml(text) == text


@given(st.text(st.sampled_from("ab:=-[]{},&*!|>'\"# \n\t%@`?"), max_size=40))
def test_no_spelling_of_a_config_keeps_a_password(noise: str) -> None:
    kept = public_yaml(f"{noise}\npassword: {MARKER}\n{noise}")
    assert MARKER not in kept
