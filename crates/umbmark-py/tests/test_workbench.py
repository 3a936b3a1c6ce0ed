"""The workbench that Python opens answers who has its address, until it is closed."""

from __future__ import annotations

import json
import socket
import sys
import types
import urllib.error
import urllib.request
import webbrowser
from pathlib import Path

import pytest
import umbmark


@pytest.fixture
def data() -> umbmark.Dataset:
    truth = umbmark.Model().add("wheelbase", e_b=1.01).add("wheel_noise", k_sqrt_m=0.0003)
    return umbmark.simulate(truth, runs=5, reference_rate_hz=0, seed=3)


def asked(address: str) -> bytes:
    with urllib.request.urlopen(address, timeout=20) as answer:
        body: bytes = answer.read()
        return body


def test_a_dataset_in_memory_is_shown_with_its_runs(data: umbmark.Dataset, tmp_path: Path) -> None:
    with umbmark.open(data, browser=False, drops=tmp_path / "drops") as workbench:
        assert workbench.is_open
        assert workbench.address.startswith("http://127.0.0.1:")
        assert b"<html" in asked(workbench.address)
        state = json.loads(asked(workbench.address + "api/state"))
        [place] = (tmp_path / "drops").iterdir()
        assert str(place) in json.dumps(state)
        # What stands there is the dataset.
        assert umbmark.load_dataset(place / "data").runs == data.runs
        shown = workbench._repr_html_()
        assert f'<iframe src="{workbench.address}"' in shown
        assert workbench.address in repr(workbench)
    assert not workbench.is_open
    assert repr(workbench) == "Workbench(closed)"
    assert "iframe" not in workbench._repr_html_()
    with pytest.raises(urllib.error.URLError):
        asked(workbench.address)


def test_what_stands_in_a_folder_is_served_from_there(
    data: umbmark.Dataset, tmp_path: Path
) -> None:
    data.save(tmp_path / "robot")
    drops = tmp_path / "drops"
    with umbmark.open(tmp_path / "robot", browser=False, drops=drops) as workbench:
        state = json.loads(asked(workbench.address + "api/state"))
        assert str(tmp_path / "robot") in json.dumps(state)
    assert not drops.exists()


def test_another_address_gets_nothing(tmp_path: Path) -> None:
    with umbmark.open(browser=False, drops=tmp_path) as workbench:
        host = workbench.address.split("/")[2]
        with pytest.raises(urllib.error.HTTPError) as refused:
            asked(f"http://{host}/0123/")
        with refused.value as answer:
            assert answer.code == 403


def test_what_cannot_be_served_is_said(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(umbmark.UmbmarkError, match=f"port {port} of 127.0.0.1 cannot be used"):
            umbmark.open(port=port, browser=False, drops=tmp_path)
    with pytest.raises(ValueError, match="port must be"):
        umbmark.open(port=65536, browser=False)
    with pytest.raises(ValueError, match="nowhere"):
        umbmark.open(tmp_path / "nowhere", browser=False, drops=tmp_path)
    with pytest.raises(TypeError, match="data must be a Dataset"):
        umbmark.open(3, browser=False, drops=tmp_path)  # type: ignore[arg-type]


def test_the_browser_opens_but_not_from_a_notebook(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    ipython = types.ModuleType("IPython")
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    expected: list[str] = []
    for shell, browser, opens in [
        (None, None, True),
        (types.SimpleNamespace(kernel=object()), None, False),
        (types.SimpleNamespace(kernel=object()), True, True),
        (None, False, False),
    ]:
        ipython.get_ipython = lambda shell=shell: shell  # type: ignore[attr-defined]
        with umbmark.open(browser=browser, drops=tmp_path) as workbench:
            expected += [workbench.address] * opens
        assert opened == expected


def test_waiting_ends_with_the_workbench(tmp_path: Path) -> None:
    workbench = umbmark.open(browser=False, drops=tmp_path)
    workbench.close()
    workbench.wait()
    workbench.close()
    assert not workbench.is_open
