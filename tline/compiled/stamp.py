"""Source code that a module's compiled functions depend on: its own, and that of its imports.

Compiled code holds constants, functions it inlines or links, and intrinsics from other files. All of these
enter a module by its import statements, which are followed through the package of the module and through `tline`.
"""

import ast
import hashlib
import re
import sys
import tokenize
from collections.abc import Mapping
from functools import cache, cached_property
from importlib.machinery import ModuleSpec
from importlib.util import find_spec, resolve_name

IMPORT = re.compile(r"^(?:from|import)[ \t][^\n(]*(?:\([^)]*\))?", re.MULTILINE)
Digests = Mapping[str, tuple[str, str]]  # of the text and of the meaning, by module


class SourceText:
    """Source text of a module as it was loaded; `parent` is the package that relative imports start from."""

    def __init__(self, module: str, parent: str, text: str):
        self.module, self.parent, self.text, self.digest = module, parent, text, _digest(text)

    @cached_property
    def meaning(self) -> str:
        """Digest of the syntax tree without docstrings; comments and line breaks are ignored too."""
        return _digest(ast.dump(_WithoutTexts().visit(ast.parse(self.text))))

    @cached_property
    def imports(self) -> set[str]:
        """Modules of its own package or of `tline` imported at top level, whose names compiled code uses.

        Statements are found by a pattern, since to parse a whole file takes as long as to load its compiled code.
        """
        try:
            found = ast.parse("\n".join(IMPORT.findall(self.text))).body
        except SyntaxError:  # a docstring that looks like an import, or an import that goes on in the next line
            found = ast.parse(self.text).body
        names = set[str]()
        for statement in found:
            if isinstance(statement, ast.Import):
                names |= {alias.name for alias in statement.names}
            elif isinstance(statement, ast.ImportFrom):
                origin = resolve_name("." * statement.level + (statement.module or ""), self.parent)
                names |= {_provider(origin, alias.name) for alias in statement.names}
        packages = {self.module.partition(".")[0], "tline"}
        return {name for name in names if name.partition(".")[0] in packages}


class _WithoutTexts(ast.NodeTransformer):
    """Leave out statements that consist of a string only."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        text = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        return None if text else node


_loaded: dict[str, tuple[ModuleSpec, SourceText]] = {}
_spec_of = cache(find_spec)  # of modules that are not loaded


def sources_of(*modules: str) -> dict[str, SourceText] | None:
    """Sources of modules and of all they import from their package or `tline`, by name; None if one cannot be read.

    A file is read once for each time its module is loaded, so it is the text that runs in this process even if an
    upgrade changes the file later.

    Parameters
    ----------
    *modules : str
        Names of modules. For one that is loaded, or is being loaded, the imports have been made.

    Examples
    --------
    >>> sorted(sources_of("tline.compiled.stamp"))
    ['tline.compiled.stamp']
    """
    found: dict[str, SourceText] = {}
    waiting = [*modules]
    while waiting:
        name = waiting.pop()
        source = _source(name)
        if source is None:
            return None
        found[name] = source
        waiting += source.imports - set(found)
    return found


def digests(sources: Mapping[str, SourceText]) -> Digests:
    """Digests of sources, for a later check for changes."""
    return {name: (source.digest, source.meaning) for name, source in sources.items()}


def are_unchanged(sources: Mapping[str, SourceText], then: Digests) -> bool:
    """Whether sources have the same meaning as when the digests were taken."""
    return sources.keys() == then.keys() and all(
        source.digest == then[name][0] or source.meaning == then[name][1] for name, source in sources.items()
    )


def _source(name: str) -> SourceText | None:
    try:
        spec = getattr(sys.modules.get(name), "__spec__", None) or _spec_of(name)
    except (ImportError, ValueError):
        return None
    if spec is None:
        return None
    if name not in _loaded or _loaded[name][0] is not spec:
        text = _text(spec)
        if text is None:
            return None
        _loaded[name] = spec, SourceText(spec.name, spec.parent or "", text)
    return _loaded[name][1]


def _text(spec: ModuleSpec) -> str | None:
    """Source text from the module's loader, such as an archive's; else from its file."""
    get_source = getattr(spec.loader, "get_source", None)
    if get_source:
        return get_source(spec.name)
    try:
        with tokenize.open(spec.origin or "") as file:
            return file.read()
    except (OSError, SyntaxError):
        return None


def _provider(origin: str, name: str) -> str:
    """Module that `from origin import name` refers to."""
    inner = f"{origin}.{name}"
    module = sys.modules.get(inner)
    return inner if module is not None and getattr(sys.modules.get(origin), name, None) is module else origin


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()
