"""A release: workflows call scripts and hold nothing else, versions agree, crates can be packed."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

sys.path.insert(0, str(Path(__file__).resolve().parent))

import release

TOP = release.TOP
WORKFLOWS = sorted((TOP / ".github" / "workflows").glob("*.yml"))
MANIFEST: dict[str, Any] = tomllib.loads((TOP / "Cargo.toml").read_text(encoding="utf-8"))
PACKAGE: dict[str, Any] = MANIFEST["workspace"]["package"]
# What a step may run, beside scripts of .ci.
PROGRAMS = ("cargo publish ", "gh release create ")


def loaded(file: Path) -> Any:
    """A file of YAML."""
    return yaml.safe_load(file.read_text(encoding="utf-8"))


def steps(workflow: Any) -> list[dict[str, Any]]:
    """The steps of all its jobs."""
    return [step for job in workflow["jobs"].values() for step in job.get("steps", [])]


def calls_all_checks(file: Path) -> bool:
    """Whether it runs .ci/run, itself or by a workflow that does."""
    workflow = loaded(file)
    called = [job["uses"] for job in workflow["jobs"].values() if "uses" in job]
    return any(step.get("run") == ".ci/run" for step in steps(workflow)) or any(
        calls_all_checks(TOP / other) for other in called
    )


@pytest.mark.parametrize("file", WORKFLOWS, ids=lambda file: file.name)
def test_a_workflow_calls_ci_run_and_scripts_and_holds_no_other_logic(file: Path) -> None:
    workflow = loaded(file)
    assert {"name", "permissions", "jobs"} <= workflow.keys()
    assert calls_all_checks(file), "it does not run .ci/run"
    for step in steps(workflow):
        if "uses" in step:
            assert re.search(r"@\S+$", step["uses"]), f"{step['uses']}: which version?"
            continue
        command = step["run"].strip()
        assert not re.search(r"\n|&&|;|\||`|\$\(", command), f"a script could say this: {command}"
        if found := re.match(r"(?:python3? )?(\.ci/\S+)", command):
            script = TOP / found[1]
            assert script.exists(), command
            assert command.startswith("python") or os.access(script, os.X_OK), command
        else:
            assert command.startswith(PROGRAMS), command


def test_every_release_waits_for_the_checks() -> None:
    jobs = loaded(TOP / ".github" / "workflows" / "release.yml")["jobs"]
    others = {name for name in jobs if name != "publish"}
    assert set(jobs["publish"]["needs"]) == others


def test_the_same_kinds_of_machine_everywhere() -> None:
    jobs = loaded(TOP / ".github" / "workflows" / "release.yml")["jobs"]
    wheels, archives = (
        {row["target"] for row in jobs[name]["strategy"]["matrix"]["include"]}
        for name in ("wheels", "archives")
    )
    assert wheels == archives
    formula = (TOP / "packaging" / "umbmark.rb").read_text(encoding="utf-8")
    named = set(re.findall(r"#\{version\}-([\w-]+)\.tar\.gz", formula))
    assert named == {target for target in archives if "windows" not in target}
    denied = tomllib.loads((TOP / "deny.toml").read_text(encoding="utf-8"))
    assert archives == set(denied["graph"]["targets"])


def versions() -> dict[str, str]:
    """The version of umbmark, wherever it stands."""
    found = {
        f"Cargo.toml: {name}": value["version"]
        for name, value in MANIFEST["workspace"]["dependencies"].items()
        if name.startswith("umbmark")
    }
    locked = tomllib.loads((TOP / "Cargo.lock").read_text(encoding="utf-8"))
    found |= {
        f"Cargo.lock: {package['name']}": package["version"]
        for package in locked["package"]
        if package["name"].startswith("umbmark")
    }
    found["CITATION.cff"] = loaded(TOP / "CITATION.cff")["version"]
    found["recipe.yaml"] = loaded(TOP / "packaging" / "recipe.yaml")["context"]["version"]
    for name, pattern in (
        ("packaging/umbmark.rb", r'^  version "(.*)"$'),
        ("crates/umbmark-odometry-c/ros2/package.xml", r"<version>(.*)</version>"),
    ):
        matches = re.findall(pattern, (TOP / name).read_text(encoding="utf-8"), re.MULTILINE)
        found |= {f"{name}, {number}": version for number, version in enumerate(matches)}
        assert matches, name
    return found


def test_the_version_is_the_same_everywhere() -> None:
    others = {place: found for place, found in versions().items() if found != release.version()}
    assert not others, f"Cargo.toml says {release.version()}"
    python = tomllib.loads((release.TOP / "crates/umbmark-py/pyproject.toml").read_text("utf-8"))
    assert python["project"]["dynamic"] == ["version"], "it is that of the crate"


def test_the_changelog_begins_with_this_version_or_with_what_is_not_released() -> None:
    text = (TOP / "CHANGELOG.md").read_text(encoding="utf-8")
    first = re.findall(r"^## (.*)$", text, re.MULTILINE)[0]
    tag = os.environ.get("GITHUB_REF_NAME", "")
    if os.environ.get("GITHUB_REF_TYPE") == "tag":
        assert tag == f"v{release.version()}", "the tag names another version"
        assert re.match(rf"{re.escape(release.version())}, \d{{4}}-\d\d-\d\d$", first), first
    else:
        assert re.match(rf"Unreleased$|{re.escape(release.version())}, \d{{4}}-\d\d-\d\d$", first)


def test_the_address_is_the_same_everywhere() -> None:
    repository = PACKAGE["repository"]
    assert loaded(TOP / "CITATION.cff")["repository-code"] == repository
    for name in ("umbmark.rb", "recipe.yaml"):
        text = (TOP / "packaging" / name).read_text(encoding="utf-8")
        addresses = re.findall(r"https://[^/\s]+/[^/\s]+/[^/\s\"]+", text)
        assert addresses
        assert set(addresses) == {repository}, name
    python = tomllib.loads((TOP / "crates/umbmark-py/pyproject.toml").read_text("utf-8"))
    assert python["project"]["urls"]["Repository"] == repository


def test_the_oldest_rust_is_the_same_everywhere() -> None:
    told = subprocess.run(
        [TOP / ".ci" / "oldest_rust", "--name"], capture_output=True, text=True, check=True
    ).stdout
    assert told.strip() == PACKAGE["rust-version"]
    readme = (TOP / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"Rust (\d+\.\d+)", readme) == [PACKAGE["rust-version"]]


@pytest.fixture(scope="module")
def crates() -> dict[str, Any]:
    """What Cargo knows of each crate that is published."""
    told = subprocess.run(
        ["cargo", "metadata", "--no-deps", "--format-version", "1"],
        cwd=TOP,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    packages = json.loads(told)["packages"]
    return {each["name"]: each for each in packages if each["publish"] != []}


def test_published_crates_say_what_they_are(crates: dict[str, Any]) -> None:
    for name, crate in crates.items():
        for key in ("description", "license", "repository", "readme", "rust_version", "authors"):
            assert crate[key], f"{name} has no {key}"
        assert 0 < len(crate["keywords"]) <= 5, name
        assert crate["categories"], name
        for dependency in crate["dependencies"]:
            if dependency.get("path"):
                assert dependency["name"] in crates, f"{name}: {dependency['name']} stays here"
                assert dependency["req"] == f"^{release.version()}", name


def test_published_crates_hold_their_licences_and_every_file_that_they_include(
    crates: dict[str, Any],
) -> None:
    for name, crate in crates.items():
        listed = subprocess.run(
            ["cargo", "package", "--list", "--allow-dirty", "--offline", "--package", name],
            cwd=TOP,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()
        assert {"LICENSE-APACHE", "LICENSE-MIT", "README.md"} <= set(listed), name
        folder = Path(crate["manifest_path"]).parent
        for file in (folder / "src").rglob("*.rs"):
            for other in re.findall(
                r"include_(?:str|bytes)!\(\"(.*?)\"\)", file.read_text(encoding="utf-8")
            ):
                place = (file.parent / other).resolve()
                assert place.relative_to(folder).as_posix() in listed, f"{file}: {other}"


def test_a_release_fills_in_every_checksum(tmp_path: Path) -> None:
    formula = (TOP / "packaging" / "umbmark.rb").read_text(encoding="utf-8")
    names = {release.sdist()} | {
        f"umbmark-{release.version()}-{target}.tar.gz"
        for target in re.findall(r"#\{version\}-([\w-]+)\.tar\.gz", formula)
    }
    for name in names:
        release.pack(tmp_path / name, "umbmark", {"umbmark": name.encode(), "man/umbmark.1": b""})
    sums = set()
    for name in ("umbmark.rb", "recipe.yaml"):
        template = (TOP / "packaging" / name).read_text(encoding="utf-8")
        filled = release.with_sums(template, tmp_path)
        assert release.NO_SUM not in filled, name
        sums |= set(re.findall(r"[0-9a-f]{64}", filled))
    assert sums == {release.checksum(tmp_path / name) for name in names}


def test_binstall_finds_the_archive_under_the_name_that_it_has(crates: dict[str, Any]) -> None:
    told = crates["umbmark-cli"]["metadata"]["binstall"]
    name = "umbmark-{ version }-{ target }"
    assert told["pkg-url"].endswith(f"/v{{ version }}/{name}.tar.gz")
    assert told["bin-dir"] == f"{name}/{{ bin }}{{ binary-ext }}"
