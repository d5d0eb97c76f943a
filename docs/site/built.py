"""Check the built site: each link and anchor has a target, and no external resource is loaded."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADS = {
    "script": "src",
    "img": "src",
    "link": "href",
    "iframe": "src",
    "source": "src",
    "video": "src",
}
NO_LOAD = {"canonical", "prev", "next", "license", "author"}
"""Values of `rel` with which a `link` element refers to a page without loading it."""


class Page(HTMLParser):
    """Parser that collects the links, loaded resources and anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the links, loaded resources and anchors of a tag."""
        of = {name: value or "" for name, value in attrs}
        self.anchors |= {of[name] for name in ("id", "name") if name in of}
        if tag == "a" and "href" in of:
            self.links.append(of["href"])
        if tag in LOADS and LOADS[tag] in of and not set(of.get("rel", "").split()) & NO_LOAD:
            self.loads.append(of[LOADS[tag]])
        self.loads += [part.split()[0] for part in of.get("srcset", "").split(",") if part.strip()]


def outside(address: str) -> bool:
    """Return True if an address is on another machine."""
    return bool(urlsplit(address).netloc) or urlsplit(address).scheme in ("http", "https", "ftp")


def faults(folder: Path, skip: tuple[str, ...] = ()) -> list[str]:
    """Return the faults in the pages of a site; pages under `skip` are only link targets."""
    pages = {
        path: Page(path.read_text(encoding="utf-8"))
        for path in sorted(folder.rglob("*.html"))
        if path.relative_to(folder).parts[0] not in skip
    }
    problems = []
    for path, page in pages.items():
        name = path.relative_to(folder)
        problems += [f"{name}: loads {address}" for address in page.loads if outside(address)]
        # The page for missing addresses is served from any depth.
        if path.name == "404.html":
            continue
        for address in {*page.links, *(a for a in page.loads if not outside(a))}:
            parts = urlsplit(address)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            if not target.exists():
                problems.append(f"{name}: {address} is not there")
            elif target in pages and unquote(parts.fragment) not in pages[target].anchors:
                problems.append(f"{name}: {address} has no such anchor")
    for sheet in sorted(folder.rglob("*.css")):
        text = sheet.read_text(encoding="utf-8", errors="replace")
        for word in ("url(http", "url('http", 'url("http', "url(//", "@import"):
            if word in text and sheet.relative_to(folder).parts[0] not in skip:
                problems.append(f"{sheet.relative_to(folder)}: {word}")
    return problems
