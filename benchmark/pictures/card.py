"""The card that each picture is drawn on: its own background and colors, for light and dark screens."""

STYLE = """\
:root { --card: #ffffff; --edge: #d0d7de; --ink: #1f2328; --muted: #59636e; --grid: #e6e9ed; --tint: #fff1e5;
  --raw: #bc4c00; --ours: #0969da; --green: #1a7f37; --violet: #8250df }
@media (prefers-color-scheme: dark) { :root { --card: #0d1117; --edge: #30363d; --ink: #e6edf3; --muted: #9198a1;
  --grid: #21262d; --tint: #2b1d10; --raw: #f0883e; --ours: #58a6ff; --green: #3fb950; --violet: #bc8cff } }
text { font: 14px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; fill: var(--ink) }
.muted { fill: var(--muted) } .small { font-size: 12px } .bold { font-weight: 600 }
.title { font-size: 17px; font-weight: 600 }
.end { text-anchor: end } .middle { text-anchor: middle }
.grid { stroke: var(--grid); stroke-width: 1 } .axis { stroke: var(--muted); stroke-width: 1 }
"""


def card(width: int, height: int, title: str, style: str, content: str) -> str:
    """An SVG file that fetches nothing; `title` is read aloud in the place of the picture."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="{title}">\n'
        f"<title>{title}</title>\n<style>\n{STYLE}{style}</style>\n"
        f'<rect x="0.5" y="0.5" width="{width - 1}" height="{height - 1}" rx="10"'
        ' style="fill: var(--card); stroke: var(--edge)"/>\n'
        f"{content}</svg>\n"
    )


def label(x: float, y: float, text: str, classes: str = "") -> str:
    """A line of text whose baseline begins, ends or is centered at (x, y)."""
    return f'<text x="{x:g}" y="{y:g}"{f" class={classes!r}" if classes else ""}>{text}</text>\n'


def line(x1: float, y1: float, x2: float, y2: float, classes: str) -> str:
    """A straight line."""
    return f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}" class="{classes}"/>\n'
