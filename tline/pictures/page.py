"""Reports of headings, tables and pictures, as self-contained HTML pages or as PDF."""

from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

from tline.atomic import replacing
from tline.errors import InputError
from tline.presentation import as_image

STYLE = """body{font:15px/1.45 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;font-size:13px;margin:.6rem 0}th,td{padding:.2rem .6rem;border-bottom:1px solid #ddd;
vertical-align:top}td:first-child{white-space:nowrap}tr.no{background:#fbe9e0}.two{display:flex;gap:3rem;flex-wrap:wrap}img{max-width:100%;height:auto}
code{font-size:12px}@media print{body{margin:0;max-width:none;font-size:11px}table{font-size:9px}
tr,figure,img{break-inside:avoid}h2{break-after:avoid}}"""


def page(title: str, parts: Iterable[str]) -> str:
    """Compose a page from its parts, which are HTML already."""
    title = escape(title)
    head = f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
    return "\n".join([head, f"<h1>{title}</h1>", *parts, "</html>"])


def save_page(text: str, path: str | Path) -> None:
    """Write a page, ``.html``, or ``.pdf`` on sheets of A4."""
    content = text.encode()
    if Path(path).suffix.lower() == ".pdf":
        from tline.pictures.printed import print_page

        content = print_page(text, str(path))
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def table(head: Sequence[str], rows: Iterable[Sequence[str]], marks: Sequence[str] = ()) -> str:
    """Format cells of text below their headings, columns of numbers to the right; marks are attributes of the rows."""
    rows = [*rows]
    sides = ["left", *("right" if all(map(_is_number, cells)) else "left" for cells in [*zip(*rows, strict=True)][1:])]
    sides += ["left"] * (len(head) - len(sides))

    def cells(tag: str, row: Sequence[str]) -> str:
        both = zip(sides, row, strict=True)
        return "".join(f'<{tag} align="{side}">{escape(cell)}</{tag}>' for side, cell in both)

    lines = (f"<tr{mark}>{cells('td', row)}</tr>" for mark, row in zip(marks or [""] * len(rows), rows, strict=True))
    return f"<table><tr>{cells('th', head)}</tr>{''.join(lines)}</table>"


def _is_number(cell: str) -> bool:
    return not cell.lstrip("-+.") or cell.lstrip("-+.")[0].isdigit()


def drawn(draw: Any, *given: Any) -> str:
    """Return a picture, or the reason why there is none."""
    try:
        return f"<figure>{as_image(draw(*given))}</figure>"
    except InputError as error:  # such as a network too large to be laid out without positions
        return f"<p>{escape(str(error))}</p>"
