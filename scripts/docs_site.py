"""Gathers the pages of the documentation site, and checks what was built from them (scripts/docs calls both)."""

from __future__ import annotations

import ast
import os
import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

PAGES = Path("build/docs/pages")
HTML = Path("build/docs/html")
PACKAGE = Path("build/docs/python/crossgait")
MODULES = ["crossgait", "crossgait.envs", "crossgait.terms", "crossgait.sb3", "crossgait.rsl_rl", "crossgait.policies", "crossgait.sweep", "crossgait.train"]
# Where they are in the repository, so that their links among each other hold on the site as on a Git host.
SOURCES = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md", "LICENSE", "docs", "models/README.md",
           "models/policies", "examples"]


def public_names(module: str) -> list[str]:
    """The names in a module's __all__, or the ones it defines without an underscore; read without importing it."""
    base = PACKAGE.joinpath(*module.split(".")[1:])
    file = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
    body = ast.parse(file.read_text()).body
    for node in body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            return [name for name in ast.literal_eval(node.value) if not name.startswith("__")]
    defined = [node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))]
    return [name for name in defined if not name.startswith("_")]


def gather(stub: Path) -> None:
    """Lays out in build/docs what MkDocs reads: pages, and the package with the compiled module's stub."""
    shutil.rmtree("build/docs", ignore_errors=True)
    shutil.copytree("python/crossgait", PACKAGE, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(stub, PACKAGE / "_core.pyi")
    for source in map(Path, SOURCES):
        (PAGES / source).parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, PAGES / source, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, PAGES / source)
    reference = PAGES / "reference"
    reference.mkdir()
    text = "# Python reference\n"
    for module in MODULES:
        text += f"\n## {module}\n"
        text += "".join(f"\n::: {module}.{name}\n    options: {{heading_level: 3}}\n" for name in public_names(module))
    (reference / "python.md").write_text(text)
    cpp = "# C++ reference\n\nThe headers that an installation ships: [all classes and files](../cpp/index.html).\n"
    (reference / "cpp.md").write_text(cpp)


class Page(HTMLParser):
    """What a page defines, links to and loads."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(file.read_text(errors="replace"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Notes an element's anchor and what it points at."""
        values = {key: value or "" for key, value in attrs}
        self.ids |= {values[key] for key in ("id", "name") if key in values}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        elif "src" in values or (tag == "link" and values.get("rel") != "canonical"):
            self.loads.append(values.get("src") or values.get("href", ""))


def search(package: Path) -> None:
    """Puts the script by which pages search from disk beside them, in place of its address in the network."""
    place = HTML / "assets/javascripts/iframe-worker.js"
    licence = " ".join((package / "LICENSE").read_text().split())
    place.write_text(f"/* {licence} */\n{(package / 'shim/index.js').read_text()}")
    for file in HTML.rglob("*.html"):
        text = file.read_text()
        here = re.sub(r"https://[^\"']*/iframe-worker/shim", os.path.relpath(place, file.parent), text)
        if here != text:
            file.write_text(here)


def check() -> None:
    """Ends with what is broken: links, anchors, what comes from the network, public names that are not there."""
    files = {file.resolve(): Page(file) for file in HTML.rglob("*.html")}
    broken = []
    for file, page in files.items():
        where = os.path.relpath(file, HTML.resolve())
        broken += [f"{where}: loads {at} from the network" for at in page.loads if re.match(r"(https?:)?//", at)]
        if where == "404.html":  # its links are from the server's root: where it is shown is not known
            continue
        for link in page.links + page.loads:
            at = urlsplit(link)
            if at.scheme or at.netloc or link in ("", "#"):
                continue
            # Doxygen links to this heading also where all nested classes are private, and writes no heading.
            if where.startswith("cpp/") and link == "#nested-classes":
                continue
            target = (file.parent / unquote(at.path)).resolve() if at.path else file
            target = target / "index.html" if target.is_dir() and (target / "index.html").exists() else target
            if not target.exists():
                broken.append(f"{where}: {link} does not exist")
            elif at.fragment and target in files and unquote(at.fragment) not in files[target].ids:
                broken.append(f"{where}: {link} has no such anchor")
    names = {f"{module}.{name}" for module in MODULES for name in public_names(module)}
    missing = names - files[(HTML / "reference/python.html").resolve()].ids
    broken += [f"reference/python.html: {name} is missing" for name in sorted(missing)]
    if broken:
        sys.exit("docs: " + "\n".join(broken))
    print(f"{len(files)} pages, {len(names)} public Python names: every link resolves")


if __name__ == "__main__":
    if sys.argv[1] == "gather":
        gather(Path(sys.argv[2]))
    elif sys.argv[1] == "search":
        search(Path(sys.argv[2]))
    else:
        check()
