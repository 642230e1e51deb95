"""Units of ours: what each is made of, and the parts of numba that they lean on."""

import ast
import json
from pathlib import Path

import pytest
from numba.core.codegen import JITCodeLibrary
from numba.core.registry import cpu_target

from tline.cli.warm_up import found
from tline.compiled import compiler, object_code
from tline.compiled.stamp import are_unchanged, digests

ROOT = Path(__file__).parents[2]


def file_of(module):
    path = ROOT / module.replace(".", "/")
    return next((each for each in (path.with_suffix(".py"), path / "__init__.py") if each.exists()), None)


def followed(*modules):
    """Modules, and all of ours that they import at top level, by the syntax trees of their files."""
    reached, waiting = set(), [*modules]
    while waiting:
        name = waiting.pop()
        reached.add(name)
        for node in ast.parse(file_of(name).read_text()).body:
            if isinstance(node, ast.ImportFrom) and node.module.partition(".")[0] in (name.partition(".")[0], "tline"):
                inner = [f"{node.module}.{alias.name}" for alias in node.names]
                waiting += {each if file_of(each) else node.module for each in inner} - reached
    return reached


OURS = dict(found())


@pytest.mark.parametrize("where", OURS, ids=".".join)
def test_ours_are_made_of_what_they_import(where):
    """An edit of any file that a unit's module imports is an edit of the unit; so is one of how units are compiled."""
    sources = OURS[where].sources
    assert sources.keys() == followed(where[0], *object_code.COMPILING)
    then = json.loads(json.dumps(digests(sources)))
    assert are_unchanged(sources, then)
    for name, source in sources.items():
        edited = type(source)(name, "", source.text + "\nEDITED = 1\n")
        assert not are_unchanged(sources | {name: edited}, then)


def test_numba_is_what_it_was():
    """The parts of numba that units lean on; a failure here says what a new version of numba has changed."""
    overridden = {name for kind in (compiler._Part, compiler._Whole) for name in vars(kind) if name[:2] != "__"}
    leaned_on = {"_finalize_dynamic_globals", "_get_compiled_object", "get_pointer_to_function", *overridden}
    assert leaned_on - {"_names"} <= {*dir(JITCodeLibrary)}
    codegen = cpu_target.target_context.codegen()
    assert issubclass(type(codegen)._library_class, JITCodeLibrary)
    assert {"_data_layout", "_module_pass_manager", "set_env"} <= {*dir(codegen)}
    passes, builder = codegen._module_pass_manager()
    assert hasattr(passes, "run"), builder
