"""What editors show of the compiled module: its docstrings stand in its stub.

``SNAPSHOTS=overwrite pytest tests/test_stub.py`` writes them there anew.
"""

import ast
import inspect
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any, TypeAlias

from umbmark import _umbmark

PACKAGE = Path(__file__).parents[1]
STUB = PACKAGE / "python" / "umbmark" / "_umbmark.pyi"
WIDTH = 100
# A key and its type, or an item, which stands by itself.
ITEM = re.compile(r"[\w*, ]+ : |[-*] ")

Described: TypeAlias = ast.ClassDef | ast.FunctionDef


def wrapped(doc: str, width: int) -> list[str]:
    """Give a docstring in lines of a width; sections, items and examples stay as they are."""
    lines = doc.splitlines()
    made: list[str] = []
    paragraph: list[str] = []
    example = False

    def margin(line: str) -> str:
        return line[: len(line) - len(line.lstrip())]

    def end() -> None:
        if any(len(line) > width for line in paragraph):
            space = margin(paragraph[0])
            text = " ".join(line.strip() for line in paragraph)
            made.extend(
                textwrap.wrap(
                    text,
                    width,
                    initial_indent=space,
                    subsequent_indent=space,
                    break_long_words=False,
                    break_on_hyphens=False,
                )
            )
        else:
            made.extend(paragraph)
        paragraph.clear()

    for line, after in zip(lines, [*lines[1:], ""], strict=True):
        example = bool(line.strip()) and (example or line.lstrip().startswith(">>>"))
        begins_section = after.strip("- ") == "" and after.strip() != ""
        alone = example or not line.strip("- ") or begins_section or ITEM.match(line.lstrip())
        if alone or (paragraph and margin(paragraph[0]) != margin(line)):
            end()
        if alone:
            made.append(line)
        else:
            paragraph.append(line)
    end()
    return made


def described(node: Described, thing: Any, indent: int) -> list[str]:
    """Give the lines of a docstring; none where there is none."""
    doc = inspect.getdoc(thing) if "__" not in node.name and not node.name.startswith("_") else None
    if not doc:
        return []
    # One line, or the quotes stand by themselves.
    if len(doc) + indent + 6 <= WIDTH and "\n" not in doc:
        return [" " * indent + f'"""{doc}"""']
    space = " " * indent
    # Closing quotes would be put behind a single line.
    lines = wrapped(f'"""{doc}', WIDTH - indent - (0 if "\n" in doc else 3))
    body = [space + line if line else "" for line in lines]
    return [*body, f'{space}"""']


def with_docs(text: str) -> str:
    """Give a stub with the docstrings of the module in place of those that it has."""
    lines = text.splitlines()
    changes: list[tuple[int, int, list[str]]] = []

    def visit(nodes: list[ast.stmt], owner: Any) -> None:
        for node in nodes:
            if not isinstance(node, ast.ClassDef | ast.FunctionDef):
                continue
            thing = inspect.getattr_static(owner, node.name, None)
            if isinstance(thing, staticmethod | classmethod):
                thing = getattr(owner, node.name)
            is_overload = any(ast.unparse(one) == "overload" for one in node.decorator_list)
            first = node.body[0]
            has = ast.get_docstring(node, clean=False) is not None
            docs = [] if is_overload else described(node, thing, node.col_offset + 4)
            head = lines[first.lineno - 1]
            if has:
                changes.append((first.lineno - 1, first.end_lineno or 0, docs))
            elif docs and isinstance(first, ast.Expr):
                changes.append((first.lineno - 1, first.lineno, [head.removesuffix(" ..."), *docs]))
            elif docs:
                above = getattr(first, "decorator_list", [])
                at = min([first.lineno, *(one.lineno for one in above)]) - 1
                changes.append((at, at, docs))
            if isinstance(node, ast.ClassDef) and thing is not None:
                visit(node.body, thing)

    visit(ast.parse(text).body, _umbmark)
    for begin, end, put in sorted(changes, key=lambda change: change[:2], reverse=True):
        lines[begin:end] = put
    command = [sys.executable, "-m", "ruff", "format", "--config", str(PACKAGE / "pyproject.toml")]
    made = subprocess.run(
        [*command, "--stdin-filename", STUB.name, "-"],
        input="\n".join(lines) + "\n",
        capture_output=True,
        text=True,
        check=True,
    )
    return made.stdout


def test_the_stub_has_the_docstrings_of_the_module() -> None:
    text = STUB.read_text()
    made = with_docs(text)
    if os.environ.get("SNAPSHOTS") == "overwrite":
        STUB.write_text(made)
        text = made
    assert text == made, "SNAPSHOTS=overwrite pytest tests/test_stub.py writes it anew"
    assert text.count('"""') > 200
