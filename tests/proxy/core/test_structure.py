"""The house of the core: packages import one another only downward, fields are their owner's."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

CORE = Path(__file__).parents[3] / "proxy" / "core"
HERE = Path(__file__).parent
PACKAGES = (
    "model",
    "protocol",
    "interface",
    "forecast",
    "transit",
    "view",
    "market",
    "split",
    "coordination",
    "congestion",
    "window",
    "samples",
    "gossip",
    "parts",
    "status",
    "why",
    "reactions",
    "core",
)
"""From the lowest to the highest: a package imports itself and lower ones."""
SOURCES = sorted(path for path in CORE.rglob("*.py"))


def package_of(source: Path) -> str:
    return source.relative_to(CORE).parts[0].removesuffix(".py")


@cache
def parsed(source: Path) -> ast.Module:
    return ast.parse(source.read_text())


def imported(source: Path) -> Iterator[str]:
    """Yield the packages of the core that a file imports, for types alone included."""
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("proxy.core"):
            parts = node.module.split(".")
            yield from parts[2:3] or [alias.name for alias in node.names]


def foreign_writes(tree: ast.Module) -> Iterator[str]:
    """Yield the fields that are set of objects other than `self`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store | ast.Del):
            own = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
            if not own:
                yield f"line {node.lineno}: {ast.unparse(node)}"


def test_every_package_has_its_place():
    """A new package is put where it belongs."""
    found = {package_of(source) for source in SOURCES} - {"__init__"}
    assert found == set(PACKAGES)


def test_packages_import_only_downward():
    """So there is no circle, and each package can be read without those above it."""
    for source in SOURCES:
        package = package_of(source)
        if package != "__init__":
            lower = PACKAGES[: PACKAGES.index(package) + 1]
            assert set(imported(source)) <= set(lower), source


def test_files_of_a_package_have_no_circles():
    """Not even for types alone."""
    for source in SOURCES:
        own = ".".join(source.relative_to(CORE.parent.parent).with_suffix("").parts)
        assert own not in reached(own), f"{own} imports itself by way of others"


def reached(own: str) -> set[str]:
    """Return all modules of the core that one imports, by way of others too."""
    seen, todo = set[str](), list(modules_imported(own))
    while todo:
        module = todo.pop()
        if module not in seen:
            seen.add(module)
            todo += modules_imported(module)
    return seen


@cache
def modules_imported(module: str) -> list[str]:
    """Return the modules of the core that one imports."""
    source = CORE.parent.parent / f"{module.replace('.', '/')}.py"
    if not source.exists():
        return []
    found = []
    for node in ast.walk(parsed(source)):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("proxy.core"):
            found += [f"{node.module}.{alias.name}" for alias in node.names] + [node.module]
    return found


def test_nobody_writes_the_fields_of_others():
    """An object's fields are its own: others call its methods, or take what it returns."""
    written = {source: list(foreign_writes(parsed(source))) for source in SOURCES}
    assert {source: writes for source, writes in written.items() if writes} == {}


def test_tests_stand_where_their_modules_do():
    """So who changes a module finds them; what concerns several packages stands above them."""
    of_several = {"page", "recorded", "first_sends", "proposal"}  # of what is too long, or read by others, for one file
    tests = [path for path in HERE.rglob("test_*.py") if path.parent != HERE]
    names = {path: path.stem.removeprefix("test_") for path in tests}
    lost = [p for p, name in names.items() if not (CORE / p.relative_to(HERE).with_name(f"{name}.py")).exists()]
    assert {names[path] for path in lost} == of_several
