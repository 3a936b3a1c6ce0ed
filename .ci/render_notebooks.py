"""The notebooks as pages of the book: run, with what their cells print and draw.

``python .ci/render_notebooks.py`` writes docs/notebooks anew; with ``--check`` it runs the
notebooks and says which page is another. A cell that raises, or whose assertion fails, is an error
in both.
"""

import base64
import difflib
import itertools
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import jupytext
from nbclient import NotebookClient
from traitlets.config import Config

TOP = Path(__file__).resolve().parent.parent
SOURCES = sorted((TOP / "notebooks").glob("*.py"))
PAGES = TOP / "docs" / "notebooks"
# A cell before the first: figures that are small and alike at each run.
BEGIN = "%matplotlib inline\n%config InlineBackend.rc = {'figure.dpi': 72, 'savefig.dpi': 72}"
# What a cell ends in that only names a thing of matplotlib.
NAMELESS = re.compile(r"\[?(<|Text\(|\(?\[<)")
STYLE = re.compile(r"<style.*?</style>\n?", re.DOTALL)
DRAWN = re.compile(r'<img alt="(.*?)" src="data:image/svg\+xml;base64,(.*?)">')

NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")

# Files of a page by their names.
Files = dict[str, bytes]


def rendered(source: Path) -> Files:
    """Run a notebook and give its page and its images."""
    notebook: Any = jupytext.read(source)
    begin: Any = jupytext.reads(f"# %%\n{BEGIN}\n", fmt="py:percent").cells
    notebook.cells = begin + notebook.cells
    # Kernels that begin together may choose the same port; files of their own cannot be taken.
    with TemporaryDirectory() as folder:
        own = {
            "transport": "ipc",
            "ip": f"{folder}/kernel",
            "connection_file": f"{folder}/kernel.json",
        }
        config = Config({"KernelManager": own})
        client = NotebookClient(
            notebook,
            timeout=600,
            kernel_name="python3",
            coalesce_streams=True,
            config=config,
        )
        client.execute()
    files: Files = {}
    names = (f"{source.stem}_{number}" for number in itertools.count(1))
    parts = [f"<!-- Made of notebooks/{source.name} by .ci/render_notebooks.py. -->"]
    for cell in notebook.cells[len(begin) :]:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            parts += told(output, names, files)
    files[f"{source.stem}.md"] = ("\n\n".join(parts) + "\n").encode()
    return files


def told(output: Any, names: Iterator[str], files: Files) -> Iterator[str]:
    """Give what a cell prints or shows as Markdown; images go to files."""
    if output.output_type == "stream":
        # Progress and warnings are no part of the story.
        if output.name == "stdout":
            yield text(output.text)
        return
    data = output.data
    if "text/html" in data:

        def kept(match: re.Match[str]) -> str:
            name = f"{next(names)}.svg"
            files[name] = base64.b64decode(match[2])
            return f'<img alt="{match[1]}" src="{name}">'

        yield DRAWN.sub(kept, STYLE.sub("", data["text/html"])).strip()
    elif "image/svg+xml" in data:
        name = f"{next(names)}.svg"
        files[name] = data["image/svg+xml"].encode()
        yield f"![]({name})"
    elif "image/png" in data:
        name = f"{next(names)}.png"
        files[name] = base64.b64decode(data["image/png"])
        yield f"![]({name})"
    elif not NAMELESS.match(data["text/plain"]):
        yield text(data["text/plain"])


def text(words: str) -> str:
    """Give what is printed as a block."""
    lines = "\n".join(line.rstrip() for line in words.rstrip().splitlines())
    return f"```text\n{lines}\n```"


def differences(made: Files) -> Iterator[str]:
    """Say how pages differ from those that are kept.

    Of numbers four digits count, of images the names.
    """
    for name, content in made.items():
        kept = PAGES / name
        if not kept.exists():
            yield f"{kept.relative_to(TOP)} is missing"
        elif name.endswith(".md"):
            old, new = (
                NUMBER.sub(lambda number: f"{float(number[0]):.4g}", of.decode()).splitlines()
                for of in (kept.read_bytes(), content)
            )
            yield from difflib.unified_diff(old, new, name, name, lineterm="", n=0)
    if PAGES.exists():
        for file in sorted({page.name for page in PAGES.iterdir()} - {*made}):
            yield f"docs/notebooks/{file} is of no notebook"


def main() -> int:
    """Write the pages, or compare them."""
    made: Files = {}
    with ThreadPoolExecutor() as pool:
        for files in pool.map(rendered, SOURCES):
            made |= files
    if "--check" in sys.argv[1:]:
        found = [*differences(made)]
        if found:
            print(*found, "Make them anew: python .ci/render_notebooks.py", sep="\n")
        return min(len(found), 1)
    PAGES.mkdir(exist_ok=True)
    for file in PAGES.iterdir():
        file.unlink()
    for name, content in made.items():
        (PAGES / name).write_bytes(content)
    return 0


if __name__ == "__main__":
    sys.exit(main())
