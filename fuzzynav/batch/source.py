"""A short name for the code behind a function, that changes when what it computes may change.

It covers the function and every function, class and constant of its own package and of fuzzynav that it mentions,
directly or through others, followed by name from file to file. Not covered: layout, comments, docstrings, annotations
of functions, sentences of exceptions, import lines, the file in which a definition stands, other packages, and the
modules of `STORES`, which keep rows and data but compute none. Attributes looked up by a text (`getattr`) are not seen.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

__all__ = ["code_of", "digest", "dumped"]

STORES = (
    "fuzzynav.batch",
    "fuzzynav.data",
    "fuzzynav.documents",
    "fuzzynav.studies.reproduction",
    "fuzzynav.studies.study",
)
SKIPPED = ("ctx", "kind", "type_comment", "type_params", "returns", "annotation")  # of the tree, where they say nothing
Definition = tuple[str, str]  # module and name; the name "" stands for the module itself


@dataclass(frozen=True, slots=True)
class _Module:
    """A source file by its names: definitions, what it imports, and statements that only act."""

    defined: dict[str, ast.stmt]
    imported: dict[str, Definition]
    acting: list[ast.stmt]


def code_of(module: str, name: str) -> str:
    """Sixteen hexadecimal digits for a module's top-level definition and all it rests on; ValueError if not found."""
    start = _resolved((module, name), module)
    if start is None:
        raise ValueError(f"there is no definition {name} at the top of a source file {module}")
    found: dict[Definition, str] = {}
    todo = [start]
    while todo:
        key = todo.pop()
        if key in found:
            continue
        here = _module(key[0])
        assert here is not None
        nodes = here.acting if not key[1] else [here.defined[key[1]]]
        mentions: list[Definition] = [] if not key[1] else [(key[0], "")]
        found[key] = "".join(f"{key[1]}{_said(_plain(node, key[0], mentions))}" for node in nodes)
        todo += mentions
    return digest("\n".join(sorted(set(found.values()))))


def digest(text: str) -> str:
    """Sixteen hexadecimal digits for a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def dumped(source: str) -> str:
    """Source code without layout, comments and docstrings, for a function that stands in no file."""
    return _said(_plain(ast.parse(source), "", []))


def _module(dotted: str) -> _Module | None:
    """A module's source by its names, as it is on the disk now; None where it has none."""
    try:
        spec = importlib.util.find_spec(dotted)
    except (ImportError, ValueError):
        return None
    if spec is None or not spec.origin or not spec.origin.endswith(".py"):
        return None
    package = dotted if spec.submodule_search_locations is not None else dotted.rpartition(".")[0]
    return _parsed(spec.origin, os.stat(spec.origin).st_mtime_ns, package)


@cache
def _parsed(path: str, changed: int, package: str) -> _Module:
    """A source file by its names; `changed` makes an edited one another one."""
    tree = ast.parse(Path(path).read_text(encoding="utf-8"))
    module = _Module({}, {}, [])
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            module.imported.update(_imports(node, package))
    for statement in tree.body:
        names = list(_names(statement))
        module.defined.update(dict.fromkeys(names, statement))
        if not names and not _says_nothing(statement):
            module.acting.append(statement)
    return module


def _imports(node: ast.Import | ast.ImportFrom, package: str) -> Iterator[tuple[str, Definition]]:
    if isinstance(node, ast.Import):
        for alias in node.names:
            yield (
                alias.asname or alias.name.split(".")[0],
                (alias.name if alias.asname else alias.name.split(".")[0], ""),
            )
        return
    base = node.module or ""
    if node.level:
        parts = package.split(".")
        base = ".".join([*parts[: len(parts) - node.level + 1], *([base] if base else [])])
    for alias in node.names:
        yield alias.asname or alias.name, (base, alias.name)


def _names(statement: ast.stmt) -> Iterator[str]:
    """The names that a top-level statement defines."""
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield statement.name
    elif isinstance(statement, ast.Assign | ast.AnnAssign):
        for target in statement.targets if isinstance(statement, ast.Assign) else [statement.target]:
            yield from (n.id for n in ast.walk(target) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store))


def _says_nothing(statement: ast.stmt) -> bool:
    """Imports, texts, and what runs only as a program or for a type checker."""
    if isinstance(statement, ast.If):
        return any(name in ast.unparse(statement.test) for name in ("__name__", "TYPE_CHECKING"))
    text = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    return text or isinstance(statement, ast.Import | ast.ImportFrom)


def _followed(dotted: str, of: str) -> bool:
    """Whether a module belongs to the package at hand or to fuzzynav, and computes."""
    stores = any(dotted == s or dotted.startswith(f"{s}.") for s in STORES)
    return dotted.split(".")[0] in ("fuzzynav", of.split(".")[0]) and not stores


def _resolved(key: Definition, of: str) -> Definition | None:
    """Where a name is defined, through what hands it on; name "" for a module; None for what is not followed."""
    seen = set()
    while key not in seen and _followed(key[0], of):
        seen.add(key)
        module, name = key
        here = _module(module)
        if here is None:
            return None
        if not name or name in here.defined:
            return key
        key = here.imported.get(name, (f"{module}.{name}", ""))
    return None


def _plain(node: Any, module: str, mentions: list[Definition]) -> Any:
    """A tree as nested tuples, without what says nothing; names of other definitions are added to `mentions`."""
    if isinstance(node, list):
        return tuple(_plain(n, module, mentions) for n in node if not _is_docstring(n))
    if not isinstance(node, ast.AST):
        return node
    if isinstance(node, ast.Name | ast.Attribute) and module:
        known = _mentioned(node, module, mentions)
        if known is not None:
            return known
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
        return "Raise", _plain(node.exc.func, module, mentions)
    if isinstance(node, ast.Import | ast.ImportFrom):
        return "Import"
    fields = [
        (name, _plain(value, module, mentions))
        for name, value in ast.iter_fields(node)
        if value is not None and value != [] and (name not in SKIPPED or isinstance(node, ast.AnnAssign))
    ]
    return type(node).__name__, *(f for f in fields if f[0] != "ctx")


def _is_docstring(node: Any) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _mentioned(node: ast.Name | ast.Attribute, module: str, mentions: list[Definition]) -> Any:
    """`blend.kernels.INDEX` as ("INDEX", ()), whatever the way to it; None if it leads to no definition."""
    chain: list[str] = []
    inner: ast.expr = node
    while isinstance(inner, ast.Attribute):
        chain.insert(0, inner.attr)
        inner = inner.value
    if not isinstance(inner, ast.Name):
        return None
    here = _module(module)
    known = here is not None and (inner.id in here.defined or inner.id in here.imported)
    key = _resolved((module, inner.id), module) if known else None
    while key is not None and not key[1] and chain:
        key = _resolved((key[0], chain.pop(0)), module)
    if key is None or not key[1]:
        return None
    mentions.append(key)
    return key[1], tuple(chain)


def _said(tree: Any) -> str:
    return repr(tree)
