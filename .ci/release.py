"""What a release consists of, beside the crates and wheels.

``archive FOLDER`` builds the program and packs it for this kind of machine, as ``cargo binstall``
and the formula expect it. ``finish FOLDER`` writes the files that need every archive: checksums,
formula, recipe, and what the changelog says of this version. ``python FOLDER`` moves what goes to
Python's index into a folder of its own.
"""

import hashlib
import io
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
PACKAGING = TOP / "packaging"
# As they stand in the archive, beside the program.
TEXTS = ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"]
PAGES = {
    "man": "man/umbmark.1",
    "bash": "completions/umbmark.bash",
    "zsh": "completions/_umbmark",
    "fish": "completions/umbmark.fish",
    "power-shell": "completions/_umbmark.ps1",
}
NO_SUM = "0" * 64


def version() -> str:
    """The version of all crates and of the Python package."""
    manifest = tomllib.loads((TOP / "Cargo.toml").read_text(encoding="utf-8"))
    found: str = manifest["workspace"]["package"]["version"]
    return found


def sdist() -> str:
    """The name of the Python package's source."""
    return f"umbmark-{version()}.tar.gz"


def target() -> str:
    """The kind of machine for which Rust builds here."""
    told = subprocess.run(["rustc", "-vV"], capture_output=True, text=True, check=True).stdout
    found = re.search(r"^host: (\S+)$", told, re.MULTILINE)
    assert found, told
    return found[1]


def archive(folder: Path) -> None:
    """Build the program and pack it, with its manual page and completions."""
    subprocess.run(
        ["cargo", "build", "--release", "--locked", "--package", "umbmark-cli"], cwd=TOP, check=True
    )
    program = TOP / "target" / "release" / "umbmark"
    if sys.platform == "win32":
        program = program.with_suffix(".exe")
    members = {program.name: program.read_bytes()}
    members |= {name: (TOP / name).read_bytes() for name in TEXTS}
    for kind, name in PAGES.items():
        members[name] = subprocess.run(
            [program, "completions", kind], capture_output=True, check=True
        ).stdout
    name = f"umbmark-{version()}-{target()}"
    pack(folder / f"{name}.tar.gz", name, members)


def pack(file: Path, top: str, members: dict[str, bytes]) -> None:
    """Write an archive of files below one folder."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with tarfile.open(file, "w:gz") as packed:
        for name, content in members.items():
            member = tarfile.TarInfo(f"{top}/{name}")
            member.size = len(content)
            member.mode = 0o755 if Path(name).stem == "umbmark" and "/" not in name else 0o644
            packed.addfile(member, io.BytesIO(content))


def checksum(file: Path) -> str:
    """The SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def notes() -> str:
    """What the changelog says of this version."""
    text = (TOP / "CHANGELOG.md").read_text(encoding="utf-8")
    found = re.search(
        rf"^## {re.escape(version())}\b[^\n]*\n(.*?)(?=^## |\Z)", text, re.DOTALL | re.MULTILINE
    )
    if not found:
        sys.exit(f"CHANGELOG.md has no heading '## {version()}'")
    return found[1].strip() + "\n"


def with_sums(text: str, folder: Path) -> str:
    """The formula or the recipe, with the checksum of each file that the line before names."""

    def filled(match: re.Match[str]) -> str:
        name = re.sub(r"#\{version\}|\$\{\{ version \}\}", version(), match["name"])
        return match["before"] + checksum(folder / name)

    return re.sub(
        rf"(?P<before>/(?P<name>umbmark-[^/\n]*\.tar\.gz)\"?\n\s*sha256:? \"?){NO_SUM}",
        filled,
        text,
    )


def finish(folder: Path) -> None:
    """Write checksums, formula, recipe and notes beside the archives."""
    (folder / "notes.md").write_text(notes(), encoding="utf-8")
    for name in ("umbmark.rb", "recipe.yaml"):
        text = with_sums((PACKAGING / name).read_text(encoding="utf-8"), folder)
        if NO_SUM in text:
            sys.exit(f"packaging/{name}: a checksum is left out")
        (folder / name).write_text(text, encoding="utf-8")
    files = sorted([*folder.glob("*.tar.gz"), *folder.glob("*.whl")])
    lines = [f"{checksum(file)}  {file.name}\n" for file in files]
    (folder / "SHA256SUMS").write_text("".join(lines), encoding="utf-8")


def python(folder: Path) -> None:
    """Move wheels and source of the Python package into a folder of their own."""
    own = folder / "python"
    own.mkdir()
    for file in [*folder.glob("*.whl"), folder / sdist()]:
        shutil.move(file, own)


def main() -> None:
    """Do what the command line says."""
    parts = {"archive": archive, "finish": finish, "python": python}
    match sys.argv[1:]:
        case [part, folder] if part in parts:
            parts[part](Path(folder))
        case _:
            sys.exit(f"usage: release.py {'|'.join(parts)} FOLDER")


if __name__ == "__main__":
    main()
