"""PDF reports: pages of HTML on sheets of A4, set by fpdf2."""

import re
from datetime import UTC, datetime
from pathlib import Path

from matplotlib import get_data_path

from tline.errors import import_extra
from tline.style import INK

MARGIN, WIDE = 16, 500  # mm; points, of pictures
SIZES = {"h1": 17.0, "h2": 12.5, "p": 9.0, "li": 9.0, "ul": 9.0}  # points
CELL, WRAPPED, PADDING = 6.5, 16, 3  # points; characters of cells with several words, and beside them
FAILED = "#fbe9e0"  # rows of scenarios that fail
FONTS = {"": "DejaVuSans", "b": "DejaVuSans-Bold"}  # those of Matplotlib: they have Greek letters and signs


def print_page(text: str, where: str) -> bytes:
    """Set a page of HTML, made by `tline.pictures.page`, as PDF; errors name `where`.

    Raises
    ------
    MissingExtraError
        fpdf2 is not installed.
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
