"""Packages whose public names are imported at first use: their stub lists these and their modules."""

import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any


def lazy(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return functions ``__getattr__`` and ``__dir__`` of a package with a stub (PEP 562).

    Parameters
    ----------
    package : str
        Its ``__name__``. Next to its ``__init__.py`` there must be an ``__init__.pyi`` of statements
        ``from where import name as name``, ``from where import *`` or ``import module as module``, which type checkers
        and editors read, too.

    Returns
    -------
    getattr, dir : callable
        The first imports a public name when it is first used, and knows ``__all__``.

    Examples
    --------
    >>> import tline
    >>> "simulate" in dir(tline), tline.line.ElectricalLine is tline.ElectricalLine
    (True, True)
    >>> tline.simulat  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    AttributeError: module 'tline' has no attribute 'simulat'...
    """

    @cache
    def homes() -> dict[str, tuple[str, str]]:  # module, and name in it; none for the module itself
        import ast
        from importlib.util import resolve_name
        from pkgutil import get_data

        found = {}
        for statement in ast.parse(get_data(package, "__init__.pyi") or b"").body:
            if isinstance(statement, ast.ImportFrom):
                home = resolve_name("." * statement.level + (statement.module or ""), package)
                names = [(alias.asname or alias.name, alias.name) for alias in statement.names]
                if names == [("*", "*")]:
                    names = [(name, name) for name in import_module(home).__all__]
                found |= {name: (home, inside) for name, inside in names}
            elif isinstance(statement, ast.Import):
                found |= {alias.name: (alias.name, "") for alias in statement.names}
        return found

    def __getattr__(name: str) -> Any:
        if name == "__all__":
            return sorted(homes())
        if name.startswith("__") or name not in homes():
            raise AttributeError(f"module '{package}' has no attribute '{name}'", name=name, obj=sys.modules[package])
        home, inside = homes()[name]
        if home == package:
            home, inside = f"{home}.{inside}", ""
        value = getattr(import_module(home), inside) if inside else import_module(home)
        setattr(sys.modules[package], name, value)
        return value

    def __dir__() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes()})

    return __getattr__, __dir__
