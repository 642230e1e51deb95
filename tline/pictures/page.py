"""Reports of headings, tables and pictures, as self-contained HTML pages or as PDF on sheets of A4."""

import re
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from html import escape
from pathlib import Path
from typing import Any

from matplotlib import get_data_path

from tline.atomic import replacing
from tline.errors import InputError, import_extra
from tline.presentation import as_image
from tline.style import INK

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


MARGIN, WIDE = 16, 500  # mm; points, of pictures
SIZES = {"h1": 17.0, "h2": 12.5, "p": 9.0, "li": 9.0, "ul": 9.0}  # points
CELL, WRAPPED, PADDING = 6.5, 16, 3  # points; characters of cells with several words, and beside them
FAILED = "#fbe9e0"  # rows of scenarios that fail
FONTS = {"": "DejaVuSans", "b": "DejaVuSans-Bold"}  # those of Matplotlib: they have Greek letters and signs


def print_page(text: str, where: str) -> bytes:
    """Set a page of HTML, made by `tline.pictures.page`, as PDF; errors name `where`.

    Raises MissingExtraError: fpdf2 is not installed.
    """
    fpdf = import_extra("fpdf", "fpdf2", "pdf", where)
    paper = fpdf.FPDF(format="A4")
    paper.set_creation_date(datetime.fromtimestamp(0, UTC))
    paper.set_margin(MARGIN)
    for style, name in FONTS.items():
        paper.add_font("report", style, Path(get_data_path(), "fonts", "ttf", f"{name}.ttf"))
    paper.add_page()
    paper.set_font("report", size=SIZES["p"])
    look = {"color": INK, "b_margin": 1}
    styles = {
        tag: fpdf.TextStyle(font_style="B" * (tag[0] == "h"), font_size_pt=size, t_margin=size / 3, **look)
        for tag, size in SIZES.items()
    }
    paper.write_html(_plain(text), font_family="report", tag_styles=styles, li_prefix_color=INK)
    return bytes(paper.output())


def _plain(text: str) -> str:
    """Reduce a page to HTML for fpdf2: no style sheet, coloured cells of failed rows, pictures below their heading."""
    text = re.sub(r"<!doctype.*?</style>|</html>|</?(?:div|figure|code)[^>]*>", "", text, flags=re.DOTALL)
    text = re.sub(r"<h2>([^<]*</h2>\s*<img)", r'<h2 style="break-before: page">\1', text)
    text = re.sub(r'width="\d+"', f'width="{WIDE}"', text)
    cell = f'<td bgcolor="{FAILED}"'
    text = re.sub(r'<tr class="no">.*?</tr>', lambda row: row[0].replace("<td", cell), text, flags=re.DOTALL)
    text = text.replace("</table><table>", "</table><br><table>")
    return re.sub(r"<table>(.*?)</table>", _sized, text, flags=re.DOTALL)


def _sized(found: re.Match[str]) -> str:
    """Give a table's columns widths by what is in them: words stay whole, and long texts are wrapped."""
    rows = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in found[1].split("</tr>")[:-1]]
    wide = [max(max(map(len, cell.split()), default=0) for cell in column) for column in zip(*rows, strict=True)]
    most = [max(map(len, column)) for column in zip(*rows[1:], strict=True)] or wide
    widths = iter([max(least, min(long, WRAPPED)) + PADDING for least, long in zip(wide, most, strict=True)])
    sized = re.sub("<th", lambda _: f'<th width="{next(widths)}"', found[1])
    return f'<font size="{CELL}"><table>{sized}</table></font>'
