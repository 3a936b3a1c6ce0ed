"""Plain words: messages, help, docs and comments have none of the idioms that are hard to read."""

import re
import subprocess
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
TERSE = {
    "that is none": "invalid, missing or zero",
    "may as well be": "cannot be distinguished from",
    "does as well:": "indistinguishable from",
    "where it believes to be": "where its odometry says it is",
    "asks every effect": "tests every known error source",
    "had it begun without": "error added by this leg alone",
    "explain what these runs can show": "fully accounts for the measured error",
    "below, times their number": "Bonferroni-corrected",
    "is set by the motion": "is aligned from the motion",
    "was watched all the way": "was tracked",
    "holds a model against": "compares a model's prediction with",
    "where a robot wants them": "ROS 2, TOML or C files",
    "per mille": "0.1 %",
    "to mend it,": "to correct it,",
    "nobody said": "was assumed",
    "under each flip but": "under every flip except the identity",
    "is accused": "false-alarm rate",
    "told apart": "separated",
    "tell apart": "separate",
    "not what they are called": "contradict their names",
    "not what it is called": "contradicts its name",
    "most telling": "most informative",
    " on offer": "available",
    "say its own numbers": "give its own numbers",
}
"""What is not written, and what to say in its place."""
READ = {".rs", ".py", ".pyi", ".md", ".html", ".txt", ".err", ".toml", ".svg"}
HISTORY = {TOP / "CHANGELOG.md", Path(__file__).resolve()}


def plain(text: str) -> str:
    """The text in one line, without the marks of comments and of strings that go on."""
    return re.sub(r"\s+", " ", re.sub(r"\\?\n\s*(///?|//!|#|>)?", " ", text))


def test_no_text_uses_a_terse_idiom() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=TOP, capture_output=True, text=True, check=True
    ).stdout
    files = [TOP / name for name in listed.split("\0") if Path(name).suffix in READ]
    found = []
    for file in files:
        if file in HISTORY or not file.exists():
            continue
        text = plain(file.read_text(encoding="utf-8")).lower()
        found += [
            f'{file.relative_to(TOP)}: "{idiom}"; say "{better}"'
            for idiom, better in TERSE.items()
            if idiom in text
        ]
    assert not found, "\n".join(found)
