"""What an experiment is, its name, its parameters and its code: rows of another one are never taken for its own."""

from __future__ import annotations

import functools
import inspect
import re
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from types import CodeType, FunctionType, MethodType
from typing import Any

import numpy as np

from fuzzynav.batch.source import code_of, digest, dumped

__all__ = ["Label", "label_of", "printed", "refusal"]

Label = dict[str, Any]
_open: set[int] = set()  # functions whose label is being made
ADDRESS = re.compile(r"\bat 0x[0-9a-fA-F]+")


def label_of(experiment: Callable[..., Any]) -> Label:
    """The experiment's name, parameters and code.

    Parameters are what `functools.partial` binds, defaults, what a closure holds, attributes of a callable object, and
    the plain values that a function outside any file (of a notebook) reads. Raises ValueError for a parameter that
    prints a place in memory: another run could not tell it from another one.
    """
    parameters: dict[str, str] = {}
    while isinstance(experiment, functools.partial):
        bound = {**{str(k): v for k, v in enumerate(experiment.args)}, **experiment.keywords}
        parameters = {**{k: printed(v, k) for k, v in bound.items()}, **parameters}
        experiment = experiment.func
    if isinstance(experiment, MethodType):
        parameters.update(_state(experiment.__self__))
        experiment = experiment.__func__
    elif not hasattr(experiment, "__qualname__"):
        parameters.update(_state(experiment))
        experiment = type(experiment)
    function = inspect.unwrap(getattr(experiment, "py_func", experiment))
    if isinstance(function, FunctionType):
        parameters = {**_bound(function), **parameters}
    name = f"{function.__module__}.{function.__qualname__}"
    return {"experiment": name, "parameters": parameters, "code": _code(function)}


def refusal(name: str, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> str | None:
    """Why a file cannot take rows of the experiment wanted; None if it can."""
    end = "name another file or remove it"
    for key in ("study", "experiment"):
        if found.get(key) != wanted.get(key):
            who = wanted.get("study") or wanted.get("experiment")
            return f"{name} does not hold results of {who}, but of {found.get(key) or 'something else'}: {end}"
    for key in ("parameters", "inputs"):
        old, new = found.get(key, {}), wanted.get(key, {})
        for part in dict.fromkeys((*old, *new)):
            if old.get(part) != new.get(part):
                before, now = old.get(part, "nothing"), new.get(part, "nothing")
                return f"{name} was made with {part} = {before}, this is with {part} = {now}: {end}"
    if found.get("code") != wanted.get("code"):
        return f"{name} was made by other code than {wanted.get('study') or wanted.get('experiment')} has now: {end}"
    return None


def printed(value: Any, name: str) -> str:
    """A value as a text that is the same in every run, long ones shortened to a digest; ValueError if there is none."""
    text = _whole(value, name)
    return text if len(text) <= 60 else f"{text[:30]}... {digest(text)}"


def _whole(value: Any, name: str) -> str:
    if isinstance(value, np.ndarray):
        values = value.tolist() if value.dtype == object else value.tobytes().hex()
        return f"array {value.dtype} {value.shape} {values if len(str(values)) <= 30 else digest(str(values))}"
    if isinstance(value, np.generic):
        return repr(value.item())
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_whole(k, name)}: {_whole(v, name)}" for k, v in value.items()) + "}"
    if isinstance(value, set | frozenset):
        return "{" + ", ".join(sorted(_whole(v, name) for v in value)) + "}"
    if isinstance(value, list | tuple):
        return "(" + ", ".join(_whole(v, name) for v in value) + ")"
    if isinstance(value, functools.partial | FunctionType | MethodType) or hasattr(value, "py_func"):
        return _function(value)
    if isinstance(value, type):
        return f"{value.__module__}.{value.__qualname__}"
    if is_dataclass(value):
        inside = ", ".join(f"{f.name}={_whole(getattr(value, f.name), name)}" for f in fields(value))
        return f"{type(value).__qualname__}({inside})"
    text = repr(value)
    if ADDRESS.search(text):
        raise ValueError(
            f"{name} prints as {text[:80]}: a place in memory says nothing in another run, so rows could not be told "
            "apart; give it a __repr__ or make it a dataclass"
        )
    return text


def _function(value: Any) -> str:
    """A function as a parameter of another one; functions that hold each other are named once."""
    if id(value) in _open:
        return str(value.__qualname__)
    _open.add(id(value))
    try:
        label = label_of(value)
    finally:
        _open.discard(id(value))
    return f"{label['experiment']} {label['parameters']} {label['code']}"


def _state(thing: Any) -> dict[str, str]:
    """The attributes of an object that is called."""
    if is_dataclass(thing):
        return {f.name: printed(getattr(thing, f.name), f.name) for f in fields(thing)}
    return {name: printed(value, name) for name, value in getattr(thing, "__dict__", {}).items()}


def _bound(function: FunctionType) -> dict[str, str]:
    """Defaults and closure of a function, and the plain values it reads where its code stands in no file."""
    arguments = inspect.signature(function).parameters.values()
    found = {p.name: p.default for p in arguments if p.default is not inspect.Parameter.empty}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            found[name] = cell.cell_contents
        except ValueError:  # a name that is not bound yet
            found[name] = "nothing"
    found = {name: value for name, value in found.items() if value is not function}
    if not _in_a_file(function):
        found.update(_read(function, {function}))
    return {name: printed(value, name) for name, value in found.items()}


def _read(function: FunctionType, seen: set[FunctionType]) -> dict[str, Any]:
    """Global values that a function names, and those of the functions of its module that it names; these as code."""
    found: dict[str, Any] = {}
    for name in _names(function.__code__):
        value = function.__globals__.get(name)
        if _is_plain(value):
            found[name] = value
        elif isinstance(value, FunctionType) and value.__module__ == function.__module__ and value not in seen:
            seen.add(value)
            found.update({name: _code(value), **_read(value, seen)})
    return found


def _names(code: CodeType) -> set[str]:
    inner = (_names(c) for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*inner)


def _is_plain(value: Any) -> bool:
    return isinstance(value, str | int | float | bool | list | tuple | dict | np.ndarray | np.generic)


def _in_a_file(function: Any) -> str:
    """The code of a definition at the top of a module's source file, "" for any other."""
    try:
        return code_of(function.__module__, function.__qualname__)
    except ValueError:
        return ""


def _code(function: Any) -> str:
    found = _in_a_file(function)
    if found:
        return found
    try:
        return digest(dumped(textwrap.dedent(inspect.getsource(function)).strip()))
    except (OSError, TypeError, SyntaxError):  # typed at a prompt, or a lambda inside a longer line
        code = getattr(function, "__code__", None)
        return digest(f"{code.co_code.hex()} {code.co_consts}" if code else repr(function))
