"""Build of the documentation site: `make docs`. The pages are the Markdown files of the repository, as they are."""

import os
import re
import sys
from pathlib import Path

from sphinx.application import Sphinx

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))  # the code beside these pages

import gyrodrift  # noqa: E402 - after its folder is on the path
from gyrodrift.cli import COMMANDS, parser_of  # noqa: E402

project = "gyrodrift"
author = "The gyrodrift authors"
copyright = f"2026, {author}"  # noqa: A001 - Sphinx names it so
release = version = gyrodrift.__version__

extensions = ["myst_parser", "numpydoc", "sphinx.ext.autodoc"]
root_doc = "README"
include_patterns = ["*.md", "benchmark/*.md", "docs/**"]
exclude_patterns = [".*", "build", "config", "firmware_sim", "gyrodrift", "tests", "**/__pycache__"]
suppress_warnings = [
    "myst.header",  # headings may skip a level
]

myst_heading_anchors = 4
myst_enable_extensions = ["attrs_inline", "dollarmath"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # numpydoc describes the types of parameters
numpydoc_show_class_members = False

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["tables.css"]
highlight_language = "text"  # of blocks that name no language
html_title = f"gyrodrift {release}"
html_copy_source = False
templates_path = ["_templates"]
html_additional_pages = {"404": "404.html"}
SIDEBAR = ("brand", "search", "scroll-start", "navigation", "scroll-end")
versions = os.environ.get("DOCS_VERSIONS", "").split()
"""Names of the folders of a site with several versions, the newest first; `make docs-versions` sets them."""

if versions:
    html_context = {"versions": versions, "is_one_of_several": True}
    html_sidebars = {"**": [*(f"sidebar/{part}.html" for part in SIDEBAR), "versions.html"]}
linkcheck_ignore = [r"http://(127\.0\.0\.1|localhost)"]

LINK = re.compile(r"\]\(([\w./-]+\.md)\)")
ANCHOR = re.compile(r'<a id="([\w-]+)"></a>')
API, TERMINAL = "docs/api", "docs/terminal"


def contents() -> str:
    """Hidden tables of contents: one for each section of docs/README.md, and one for pages beside README.md."""
    sections = re.split(r"^## ", (ROOT / "docs" / "README.md").read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    listed = {heading: _pages_in(body) for heading, _, body in (section.partition("\n") for section in sections)}
    linked = {page for pages in listed.values() for page in pages} | {"README"}
    paths = [page.relative_to(ROOT) for pattern in ("*.md", "benchmark/*.md") for page in sorted(ROOT.glob(pattern))]
    names = [page.with_suffix("").as_posix() for page in paths]
    listed["Project"] = ["docs/README", *(name for name in names if name not in linked)]
    return "".join(_table(heading, pages) for heading, pages in listed.items())


def _pages_in(section: str) -> list[str]:
    pages = dict.fromkeys((ROOT / "docs" / target).resolve() for target in LINK.findall(section))
    names = [page.relative_to(ROOT).with_suffix("").as_posix() for page in pages]
    return [*names, *([API] if "docs/library" in names else [])]


def _table(heading: str, pages: list[str]) -> str:
    lines = "\n".join(pages)
    return f"\n```{{toctree}}\n:hidden:\n:caption: {heading}\n\n{lines}\n```\n"


def adapt(app: Sphinx, docname: str, source: list[str]) -> None:
    """Add contents, options and missing names to their pages; turn anchors of HTML into those that Sphinx checks."""
    if docname == API:
        source[0] += missing_names(source[0])
        return
    source[0] = ANCHOR.sub(r"[]{#\1}", source[0])
    if docname == TERMINAL:
        source[0] += options()
    if docname == app.config.root_doc:
        source[0] += contents()


def options() -> str:
    """The help of each command, from its parser."""
    return "".join(f"\n### {name}\n\n```text\n{parser_of(name).format_help()}```\n" for name in COMMANDS)


def missing_names(page: str) -> str:
    """Entries of public names that the page of the interface does not have yet."""
    missing = [name for name in gyrodrift.__all__ if f":: {name}\n" not in page and name != "__version__"]
    kinds = {name: "class" if isinstance(getattr(gyrodrift, name), type) else "function" for name in missing}
    entries = "\n".join(f".. auto{kind}:: {name}\n" for name, kind in kinds.items())
    return f"\nMore\n----\n\n.. currentmodule:: gyrodrift\n\n{entries}" if missing else ""


def redirect(app: Sphinx, error: Exception | None) -> None:
    """Let the address of the site show the front page."""
    if error is None and app.builder.format == "html":
        page = f'<!doctype html><meta http-equiv="refresh" content="0; url={app.config.root_doc}.html">\n'
        (app.outdir / "index.html").write_text(page, encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("source-read", adapt)
    app.connect("build-finished", redirect)
