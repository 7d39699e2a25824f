"""The rules that keep the package readable, checked by reading its source."""

import ast
import importlib
import inspect
import json
import re
import subprocess
import sys
import tomllib
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
import yaml

HOME = Path(__file__).parent.parent
PACKAGE = HOME / "fuzzynav"

# The rooms of the house, lowest first: a room may import what stands before it, never what comes after.
ROOMS = (
    "stale", "geometry", "checks", "data", "control", "documents", "batch", "robot", "maps", "fuzzy", "world",
    "sensors", "localization", "mapping", "planning", "smoothing", "simulate", "tracking", "dwa", "blend", "fusion",
    "potential", "evolve", "unknown", "physics", "ros", "decide", "studies", "published", "plot", "benchmark", "lab",
    "course", "warm",
)  # fmt: skip
# these catch what a reader's own code may raise, and turn it into a sentence
MAY_CATCH_ALL = {"batch/sweep.py", "batch/retry.py", "fusion/protocol.py"}
MODULES = sorted(p for p in PACKAGE.rglob("*.py"))


@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def room_of(dotted: str) -> str:
    return dotted.split(".")[1] if "." in dotted else ""


def dotted_name(path: Path) -> str:
    return ".".join(["fuzzynav", *path.relative_to(PACKAGE).with_suffix("").parts]).removesuffix(".__init__")


def functions(path: Path) -> list[ast.FunctionDef]:
    return [n for n in ast.walk(tree(path)) if isinstance(n, ast.FunctionDef)]


def is_kernel(function: ast.FunctionDef) -> bool:
    return any("njit" in ast.unparse(d) or "vectorize" in ast.unparse(d) for d in function.decorator_list)


def public_functions(path: Path) -> list[ast.FunctionDef]:
    found = []
    for node in tree(path).body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            found.append(node)
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found += [n for n in node.body if isinstance(n, ast.FunctionDef) and not n.name.startswith("_")]
    return found


def imported(path: Path) -> set[str]:
    """Full names of everything a module imports."""
    names = set()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


@cache
def known_modules() -> dict[str, Path]:
    return {dotted_name(path): path for path in MODULES}


def file_of(name: str) -> str | None:
    """The module that an imported full name comes from: itself, or the module that holds it."""
    while name and name not in known_modules():
        name = name.rpartition(".")[0]
    return name or None


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_imports_run_downward(path: Path) -> None:
    mine = dotted_name(path)
    if mine == "fuzzynav":
        return
    assert room_of(mine) in ROOMS, f"{name_of(path)} stands in no room of ROOMS"
    for name in imported(path):
        if not name.startswith("fuzzynav.") or file_of(name) == "fuzzynav":
            continue  # not ours, or a name of the package itself, such as __version__
        assert ROOMS.index(room_of(name)) <= ROOMS.index(room_of(mine)), f"{name_of(path)} imports {name}: upward"


def test_no_module_imports_itself_by_a_detour() -> None:
    arrows = {dotted_name(p): {f for n in imported(p) if (f := file_of(n))} - {dotted_name(p)} for p in MODULES}
    faces = {dotted_name(p) for p in MODULES if p.name == "__init__.py"}
    # a room's own files may not import its face; with that, the faces cannot close a circle unseen
    for name, targets in arrows.items():
        own = {f for f in faces if name.startswith(f + ".") and f != "fuzzynav"}
        assert name.endswith(".__main__") or not targets & own, f"{name} imports its own room's face {targets & own}"
    order: list[str] = []
    left = {name: set(targets) for name, targets in arrows.items()}
    while left:
        free = [name for name, targets in left.items() if not targets & left.keys()]
        assert free, f"a circle of imports among {sorted(left)}"
        order += free
        left = {name: targets for name, targets in left.items() if name not in free}


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_private_names_stay_in_their_folder(path: Path) -> None:
    mine, aliases = room_of(dotted_name(path)), {}
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("fuzzynav."):
            for alias in node.names:
                aliases[alias.asname or alias.name] = f"{node.module}.{alias.name}"
                private = alias.name.startswith("_") and not alias.name.startswith("__")
                assert not private or room_of(node.module) == mine, f"{name_of(path)} takes {node.module}.{alias.name}"
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in aliases:
            private = node.attr.startswith("_") and not node.attr.startswith("__")
            where = aliases[node.value.id]
            assert not private or room_of(where) == mine, f"{name_of(path)} takes {where}.{node.attr}"


@pytest.mark.parametrize("folder", sorted({p.parent for p in MODULES} - {PACKAGE}), ids=name_of)
def test_no_file_bears_the_name_of_a_function_of_its_face(folder: Path) -> None:
    face = importlib.import_module(dotted_name(folder / "__init__.py"))
    for file in folder.glob("[a-z]*.py"):
        offered = getattr(face, file.stem, None)
        assert offered is None or inspect.ismodule(offered), f"{name_of(file)} hides the face's {file.stem}"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_only_plot_draws_and_only_lab_shows_widgets(path: Path) -> None:
    folder = path.relative_to(PACKAGE).parts[0]
    tops = {n.split(".")[0] for n in imported(path)}
    if folder != "plot":
        assert "matplotlib" not in tops
    if folder != "lab":
        assert not tops & {"ipywidgets", "ipycanvas"}
    if folder != "ros":
        assert not tops & {"rospy", "rclpy", "zenoh", "rosbags"}


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_sizes(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").count("\n")
    assert lines <= 400, f"{name_of(path)} has {lines} lines: split it by topic"
    for function in functions(path):
        length = (function.end_lineno or 0) - function.lineno + 1
        doc = ast.get_docstring(function) or ""
        length -= doc.count("\n") + bool(doc)
        positional = [*function.args.posonlyargs, *function.args.args]
        assert len(positional) <= 8, f"{name_of(path)}: {function.name} has {len(positional)} positional arguments"
        if not is_kernel(function):
            assert length <= 40, f"{name_of(path)}: {function.name} has {length} lines"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_public_functions_are_typed_and_documented(path: Path) -> None:
    assert ast.get_docstring(tree(path)) or not path.read_text().strip(), f"{name_of(path)} has no docstring"
    for function in public_functions(path):
        where = f"{name_of(path)}: {function.name}"
        decorated = [ast.unparse(d) for d in function.decorator_list]
        if not any(d.endswith(".setter") for d in decorated):
            assert ast.get_docstring(function), f"{where} has no docstring"
        arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
        arguments = [a for a in arguments if a.arg not in ("self", "cls")]
        if not is_kernel(function):
            assert function.returns is not None, f"{where} has no return type"
            assert all(a.annotation for a in arguments), f"{where} has an argument without a type"
        positional = [a for a in [*function.args.posonlyargs, *function.args.args] if a.arg not in ("self", "cls")]
        assert is_kernel(function) or len(positional) <= 6, f"{where} has more than 6 positional arguments"
        if function.args.kwarg:
            # a misspelt keyword must not pass in silence: only where names are checked or handed to matplotlib
            assert name_of(path).split("/")[0] in ("plot", "lab", "checks.py"), f"{where} takes unknown keywords"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_nothing_is_swallowed_or_printed(path: Path) -> None:
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.ExceptHandler):
            caught = ast.unparse(node.type) if node.type else ""
            broad = caught in ("", "Exception", "BaseException")
            assert not broad or name_of(path) in MAY_CATCH_ALL, f"{name_of(path)}:{node.lineno} catches everything"
            empty = all(isinstance(s, ast.Pass) for s in node.body)
            assert not empty, f"{name_of(path)}:{node.lineno} swallows an exception"
    text = path.read_text(encoding="utf-8")
    prints = any(isinstance(n, ast.Call) and ast.unparse(n.func) == "print" for n in ast.walk(tree(path)))
    command_line = 'if __name__ == "__main__"' in text or path.name == "__main__.py" or path.parent.name == "course"
    assert not prints or command_line, f"{name_of(path)} prints"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_kernels_are_warmed_and_exact(path: Path) -> None:
    from fuzzynav.warm import MODULES as warmed

    text = path.read_text(encoding="utf-8")
    assert "fastmath=True" not in text
    if any(is_kernel(f) for f in functions(path)):
        dotted = "fuzzynav." + name_of(path).removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        assert dotted in warmed, f"{dotted} has kernels and is not in warm.MODULES"
        assert any(f.name == "_warm" for f in functions(path)), f"{dotted} has no _warm()"
        for function in functions(path):
            if is_kernel(function):
                assert "cache=True" in "".join(ast.unparse(d) for d in function.decorator_list), function.name


def test_every_test_asserts() -> None:
    def checks(function: ast.FunctionDef) -> bool:
        asserts = any(isinstance(n, ast.Assert) for n in ast.walk(function))
        return asserts or bool(re.search(r"\.raises\(|assert_|expect\(", ast.unparse(function)))

    for path in sorted((HOME / "tests").rglob("test_*.py")):
        helpers = {f.name for f in functions(path) if checks(f)}
        for function in functions(path):
            called = {ast.unparse(n.func) for n in ast.walk(function) if isinstance(n, ast.Call)}
            if function.name.startswith("test_"):
                assert checks(function) or called & helpers, f"{path.name}: {function.name}"


def sources() -> Counter[str]:
    """How many functions and classes name each thesis equation as the one they implement."""
    found: Counter[str] = Counter()
    for path in MODULES:
        if path.relative_to(PACKAGE).parts[0] in ("plot", "course", "studies"):
            continue
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.endswith("_as_printed"):
                doc = ast.get_docstring(node) or ""
                for match in re.finditer(r"Source: [^.]*?\beq ((?:[^.]|\.(?=\d))*)", doc):
                    named = re.sub(r"\([^)]*\)|(section|table|figure|chapter|>>>).*", "", match.group(1), flags=re.S)
                    found.update(set(re.findall(r"\b(\d\.\d+)\b", named)) & equations())
    return found


@cache
def equations() -> frozenset[str]:
    import csv

    with (HOME / "data/published/items.csv").open(encoding="utf-8") as file:
        return frozenset(
            r["id"].split("eq-")[1] for r in csv.DictReader(file) if re.fullmatch(r"thesis:eq-\d\.\d+", r["id"])
        )


def test_an_equation_has_one_home() -> None:
    twice = {eq: n for eq, n in sources().items() if n > 1}
    assert not twice, f"equations named as source by several functions: {twice}"
    assert len(sources()) > 10


@pytest.mark.parametrize("asked", [["check"], ["format", "--check"]], ids=" ".join)
def test_style_checker_is_content(asked: list[str]) -> None:
    done = subprocess.run([sys.executable, "-m", "ruff", *asked, "."], cwd=HOME, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_type_checker_is_content() -> None:
    done = subprocess.run([sys.executable, "-m", "mypy", "fuzzynav"], cwd=HOME, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def project() -> dict[str, object]:
    return tomllib.loads((HOME / "pyproject.toml").read_text())["project"]


def bare(requirement: str) -> str:
    return re.split(r"[\[<>=;!~ ]", requirement)[0].lower()


def test_one_list_of_dependencies() -> None:
    conda = yaml.safe_load((HOME / "environment.yml").read_text())
    pip = next(d["pip"] for d in conda["dependencies"] if isinstance(d, dict))
    assert conda["channels"] == ["conda-forge", "nodefaults"]
    assert pip == ["-c constraints.txt", "-e .[course]"]
    constraints = (HOME / "constraints.txt").read_text()
    assert "://" not in constraints
    pinned = {bare(line) for line in constraints.splitlines()}
    wanted = {bare(r) for r in project()["dependencies"]}
    for extra in project()["optional-dependencies"].values():
        wanted |= {bare(r) for r in extra} - {"fuzzynav"}
    assert wanted <= pinned, f"not pinned: {sorted(wanted - pinned)}"


def test_readme_gives_a_reason_for_each_dependency() -> None:
    readme = (HOME / "README.md").read_text()
    for requirement in [*project()["dependencies"], *project()["optional-dependencies"]["course"]]:
        assert re.search(rf"^\| .*{bare(requirement)}.* \| .{{10,}} \|", readme, re.M | re.I), bare(requirement)


def tracked() -> list[Path]:
    listed = subprocess.run(["git", "ls-files"], cwd=HOME, capture_output=True, text=True)
    if listed.returncode:
        folders = ("fuzzynav", "tests", "notebooks", "data")
        return [p for folder in folders for p in (HOME / folder).rglob("*") if p.is_file()]
    return [HOME / line for line in listed.stdout.splitlines() if (HOME / line).is_file()]


def test_no_path_of_a_machine_and_no_lock_file() -> None:
    machine = re.compile(r"(?<![\w.])/(home|Users|root|mnt)/[\w.-]+|[A-Z]:\\\\Users")
    for path in tracked():
        if path.suffix in (".py", ".md", ".toml", ".yml", ".txt", ".csv", ".fll") or path.name in ("Makefile", "run"):
            if path == Path(__file__):
                continue
            found = machine.search(path.read_text(encoding="utf-8"))
            assert not found, f"{path.relative_to(HOME)} names {found and found.group(0)}"
        if path.suffix == ".ipynb":
            outputs = [c.get("outputs", []) for c in json.loads(path.read_text(encoding="utf-8"))["cells"]]
            assert not machine.search(json.dumps(outputs)), path.name
        assert path.name not in ("uv.lock", "poetry.lock")
