"""What README, guides and examples promise: commands print what is shown, links lead somewhere."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

TOP = Path(__file__).resolve().parent.parent
UMBMARK = TOP / "target" / "release" / "umbmark"
# As `cargo test` built them.
PROGRAMS = TOP / "target" / "release" / "examples"
GUIDES = sorted((TOP / "docs" / "guide").glob("*.md"))
GALLERY = TOP / "docs" / "gallery.md"
PAGES = [TOP / "README.md", TOP / "examples" / "README.md", GALLERY, *GUIDES]
LINKED = [*TOP.glob("*.md"), *TOP.glob("*/*.md"), *TOP.glob("docs/*/*.md")]


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of one language."""
    return re.findall(
        rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )


def steps(page: Path) -> Iterator[tuple[str, list[str]]]:
    """Its commands in their order, each with the lines that are shown of what it prints."""
    for language, block in re.findall(
        r"^```(sh|console)\n(.*?)^```",
        page.read_text(encoding="utf-8"),
        re.DOTALL | re.MULTILINE,
    ):
        if language == "sh":
            yield from ((line, []) for line in block.splitlines() if line.startswith("umbmark "))
        else:
            for piece in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
                command, *shown = piece.splitlines()
                yield command, [line for line in shown if line != "..."]


def run(command: str, folder: Path) -> str:
    """What a command prints, run in the folder."""
    done = subprocess.run(
        command.split("#")[0].split(),
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env=os.environ | {"NO_COLOR": "1", "COLUMNS": "80"},
        executable=str(UMBMARK),
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    assert done.stdout, command
    return done.stdout


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(TOP)))
def test_every_command_of_a_page_does_what_is_shown(page: Path, tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(TOP / "examples", target_is_directory=True)
    if models := blocks(page, "toml"):
        (tmp_path / "model.toml").write_text("\n".join(models), encoding="utf-8")
    count = 0
    for command, shown in steps(page):
        printed = iter(run(command, tmp_path).splitlines())
        for line in shown:
            assert any(line == other for other in printed), (
                f"{command} does not print, in order: {line}"
            )
        for figure in re.findall(r"-o (\S+\.(?:svg|png|pdf|html))", command):
            drawn = (tmp_path / figure).read_bytes()
            assert len(drawn) > 1000, figure
            kept = TOP / "docs" / "images" / figure
            assert not kept.exists() or kept.read_bytes() == drawn, f"{figure} is another"
        count += 1
    assert count > 0, "a page without commands"


@pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.stem)
def test_a_guide_begins_with_what_you_get(page: Path) -> None:
    _, first, *_ = page.read_text(encoding="utf-8").split("\n\n")
    assert first.startswith("You get "), first


def test_every_flag_of_a_command_in_the_book_exists(tmp_path: Path) -> None:
    helps: dict[str, str] = {}
    for page in LINKED:
        text = page.read_text(encoding="utf-8")
        if page.name in ("CHANGELOG.md", "bad_flags.md"):
            continue
        commands = re.findall(r"(?:^ *(?:\$ )?|`)umbmark ([a-z]+)\b([^\n`#]*)", text, re.MULTILINE)
        for verb, rest in commands:
            for flag in re.findall(r"(?<![\w-])--[a-z][\w-]*", rest):
                if verb not in helps:
                    helps[verb] = run(f"umbmark {verb} --help", tmp_path)
                assert re.search(rf"{flag}\b(?!-)", helps[verb]), f"{page.name}: {verb} {flag}"
    assert len(helps) > 15, helps.keys()


def test_the_gallery_draws_and_shows_every_kind_of_figure(tmp_path: Path) -> None:
    kinds = run("umbmark plot --help", tmp_path).partition("\nKinds:\n")[2]
    text = GALLERY.read_text(encoding="utf-8")
    names = re.findall(r"^  (\w+)\b", kinds, re.MULTILINE)
    assert len(names) > 10, kinds
    for name in names:
        assert re.search(rf"^umbmark plot {name} .* -o {name}\.svg$", text, re.MULTILINE), name
        assert f"](images/{name}.svg)" in text, f"{name} is drawn and not shown"


@pytest.mark.parametrize(
    ("program", "figure"),
    [
        ([sys.executable, f"{TOP}/examples/fleet.py"], "fleet.svg"),
        ([str(PROGRAMS / "own_effect")], "own_effect.svg"),
    ],
    ids=["fleet", "own_effect"],
)
def test_every_program_among_the_examples_ends_in_a_figure(
    program: list[str], figure: str, tmp_path: Path
) -> None:
    (tmp_path / "examples").symlink_to(TOP / "examples", target_is_directory=True)
    subprocess.run(program, cwd=tmp_path, check=True, env=os.environ | {"MPLBACKEND": "svg"})
    assert "<svg" in (tmp_path / figure).read_text(encoding="utf-8")


def headings(page: Path) -> set[str]:
    """The anchors of its headings, as GitHub and mdBook make them."""
    lines = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).strip().replace(" ", "-") for line in lines}


@pytest.mark.parametrize("page", LINKED, ids=lambda page: str(page.relative_to(TOP)))
def test_every_link_leads_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", target):
            continue
        place, _, anchor = target.partition("#")
        file = page.parent / place if place else page
        assert file.exists(), f"{target}: there is no such file"
        if anchor and file.suffix == ".md":
            assert anchor in headings(file), f"{target}: there is no such heading"


def test_the_book_has_every_page_once() -> None:
    summary = (TOP / "docs" / "SUMMARY.md").read_text(encoding="utf-8")
    listed = re.findall(r"\]\(([^)]+\.md)\)", summary)
    pages = [page.relative_to(TOP / "docs").as_posix() for page in (TOP / "docs").rglob("*.md")]
    assert sorted(listed) == sorted(page for page in pages if page != "SUMMARY.md")
