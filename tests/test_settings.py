"""Every setting is an option and a variable, read by the same rules."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import typer.core
import typer.main

from command_line import culet, invoke
from culet.cli import app
from culet.command.config import read_config
from culet.engine.capacity.limits import Limits
from culet.errors import InputError
from culet.gateway.settings import GatewaySettings
from culet.settings import Settings, option, variable

ENDPOINTS = {"control": "ipc://unused", "frames": "ipc://unused"}


@pytest.mark.parametrize(
    ("command", "kinds"), [("serve", [GatewaySettings, Limits]), ("gateway", [GatewaySettings]), ("engine", [Limits])]
)
def test_the_help_of_a_command_names_every_setting_and_its_variable_in_full_on_80_columns(
    command: str, kinds: list[type[Settings]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    words = re.findall(r"[\w-]+", culet(command, "--help").stdout)
    fields = {name for kind in kinds for name, field in kind.model_fields.items() if not field.is_required()}
    assert len(fields) > 10
    assert [name for name in fields if option(name) not in words or variable(name) not in words] == []


def test_every_setting_says_what_it_means() -> None:
    for kind in (GatewaySettings, Limits):
        assert [name for name, field in kind.model_fields.items() if not field.description] == []


def test_an_option_counts_before_the_variable_and_the_variable_before_the_default(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert GatewaySettings.read({}, **ENDPOINTS).max_viewers == 32
    monkeypatch.setenv("CULET_MAX_VIEWERS", "5")
    assert GatewaySettings.read({}, **ENDPOINTS).max_viewers == 5
    assert GatewaySettings.read({"max_viewers": "7"}, **ENDPOINTS).max_viewers == 7
    monkeypatch.setenv("CULET_MAX_VIEWERS", "")
    assert GatewaySettings.read({}, **ENDPOINTS).max_viewers == 32


def test_sizes_have_units_and_lists_have_commas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CULET_MAX_UPLOAD_BYTES", "1.5 MiB")
    monkeypatch.setenv("CULET_ALLOW_ORIGIN", "https://a.example, https://b.example")
    settings = GatewaySettings.read({}, **ENDPOINTS)
    assert settings.max_upload_bytes == 3 << 19
    assert settings.allow_origin == ("https://a.example", "https://b.example")


@pytest.mark.parametrize(
    ("name", "value", "wanted"),
    [
        ("max_stills", "0", "expected at least 1"),
        ("max_stills", "many", "expected a whole number"),
        ("read_seconds", "nan", "expected a finite number"),
        ("max_upload_bytes", "3 furlongs", "expected a size such as 64MiB"),
    ],
)
def test_a_bad_value_is_told_by_the_name_that_its_user_gave(
    name: str, value: str, wanted: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError) as by_option:
        Limits.read({name: value})
    assert str(by_option.value) == f"{option(name)}: {wanted}; got {value!r}"
    monkeypatch.setenv(variable(name), value)
    with pytest.raises(InputError) as by_variable:
        Limits.read({})
    assert str(by_variable.value) == f"{variable(name)}: {wanted}; got {value!r}"


def test_a_bad_token_is_refused_without_being_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages end in logs, and it may be nearly the right one."""
    with pytest.raises(InputError, match=r"^--token: expected 16 to 200 letters") as by_option:
        GatewaySettings.read({"token": "hunter2 hunter2 hunter2"}, **ENDPOINTS)
    monkeypatch.setenv("CULET_TOKEN", "hunter2")
    with pytest.raises(InputError, match=r"^CULET_TOKEN: expected 16 to 200 letters") as by_variable:
        GatewaySettings.read({}, **ENDPOINTS)
    assert "hunter2" not in f"{by_option.value} {by_variable.value}"


@pytest.mark.parametrize("value", ["*", "proxy", "10.0.0.0/40", "10.0.0.1/8"])
def test_a_proxy_that_is_no_address_is_told_by_the_name_that_its_user_gave(value: str) -> None:
    with pytest.raises(InputError, match=r"^--trusted-proxy: expected an address or a network such as"):
        GatewaySettings.read({"trusted_proxy": [value]}, **ENDPOINTS)


def test_a_bad_setting_of_the_engine_is_one_line_of_serve() -> None:
    run = culet("serve", "--port", "0", "--max-stills", "-1")
    assert (run.returncode, run.stderr) == (1, "culet: --max-stills: expected at least 1; got '-1'\n")


def test_a_child_process_is_given_what_was_given() -> None:
    given = {"max_sessions": "3", "allow_origin": ["https://a.example", "https://b.example"], "max_stills": "2"}
    assert [*Limits.words(given)] == ["--max-sessions", "3", "--max-stills", "2"]
    assert [*GatewaySettings.words(given)] == [
        *("--max-sessions", "3"),
        *("--allow-origin", "https://a.example", "--allow-origin", "https://b.example"),
    ]


def test_the_variables_that_compose_hands_on_are_settings_of_their_service() -> None:
    text = (Path(__file__).parents[1] / "docker" / "compose.yaml").read_text()
    engine, others = text.partition("services:")[2].split("\n  gateway:")
    gateway = others.partition("\n  scheduler:")[0]
    of_compose_itself = {"CULET_ADDRESS", "CULET_PORT"}
    commands = typer.main.get_command(app)
    assert isinstance(commands, typer.core.TyperGroup)
    for name, service, kind in (("engine", engine, Limits), ("gateway", gateway, GatewaySettings)):
        of_container = {f"CULET_{name.upper()}_{limit}" for limit in ("MEMORY", "CPUS")}
        named = set(re.findall(r"CULET_\w+", service)) - of_compose_itself - of_container
        assert len(named) > 3
        command = commands.get_command(typer.Context(commands), name)
        assert command is not None
        own = {parameter.envvar for parameter in command.params}
        assert named <= own | {variable(field) for field in kind.model_fields}


def configured(folder: Path, text: str) -> dict[str, object]:
    """What a command with three options takes from a file; one of them is repeatable."""
    file = folder / "culet.toml"
    file.write_text(text)
    return read_config(file, {"max_sessions": False, "allow_host": True, "open": False})


def test_a_file_says_what_options_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = 'max-sessions = 20\nallow_host = ["a.example", "b.example"]\nopen = true\nmax_stills = 3'
    whole = {"max_sessions": 20, "allow_host": ["a.example", "b.example"], "open": True}
    assert configured(tmp_path, text) == whole, "max_stills is another command's"
    assert configured(tmp_path, 'allow_host = "a.example, b.example"') == {"allow_host": ["a.example", "b.example"]}
    monkeypatch.setenv("CULET_MAX_SESSIONS", "5")
    assert "max_sessions" not in configured(tmp_path, text), "the variable counts first"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("max_sesions = 3", "max_sesions: no option of a server; did you mean `max_sessions`?"),
        ("max_sessions = 0", "max-sessions: expected at least 1; got '0'"),
        ("max_stills = 0", "max-stills: expected at least 1; got '0'"),
        ("max_sessions = [1]", "max_sessions: expected a text, a number, true, false or a list of texts"),
        ("[gateway]\nport = 1", "gateway: no option of a server"),
        ("open = 1", "open: expected true or false; got 1"),
        ('max-sessions = 3\nmax_sessions = "3"', "max_sessions: is there twice"),
        ("max_sessions =", "not TOML: "),
    ],
)
def test_a_file_that_cannot_be_used_says_where_and_why(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError) as refusal:
        configured(tmp_path, text)
    assert str(refusal.value).startswith(f"{tmp_path / 'culet.toml'}: {said}")


def test_a_server_whose_file_is_missing_does_not_start(tmp_path: Path) -> None:
    run = invoke("serve", "--config", tmp_path / "nowhere.toml")
    assert run.returncode == 1
    assert run.stderr == f"culet: {tmp_path / 'nowhere.toml'}: cannot be read: No such file or directory\n"
