"""The shim to ns-3 is compiled when it is needed."""

from importlib.machinery import ModuleSpec

import pytest

from studies.ns3 import building
from studies.ns3.errors import INSTALL, Ns3Unavailable


def installed(monkeypatch, root, number="3.44.post0"):
    """Let ns-3 be installed in this folder, in this version."""
    package = ModuleSpec("ns3", None, is_package=True)
    package.submodule_search_locations = [str(root)]
    monkeypatch.setattr(building, "find_spec", lambda _: package)
    monkeypatch.setattr(building, "version", lambda _: number)


def without_headers(root):
    """Put files that are called as the libraries are into this folder; return it."""
    (root / "lib64").mkdir(parents=True)
    for module in building.MODULES:
        (root / "lib64" / f"libns3.44-{module}.so").touch()
    return root


def test_without_ns3_it_is_said_how_to_install_it(monkeypatch):
    """ns-3 is no dependency: it would bring what its Python bindings need."""
    monkeypatch.setattr(building, "find_spec", lambda _: None)
    with pytest.raises(Ns3Unavailable, match=INSTALL):
        building.shim()


def test_another_version_of_ns3_is_refused_by_its_number(monkeypatch, tmp_path):
    """The shim is written for one version."""
    installed(monkeypatch, tmp_path, number="3.99")
    with pytest.raises(Ns3Unavailable, match=r"another version of ns-3 than 3\.99"):
        building.shim()


def test_without_a_compiler_it_is_said_what_to_install(monkeypatch, tmp_path):
    """The shim is compiled on the spot."""
    installed(monkeypatch, tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(building.shutil, "which", lambda _: None)
    with pytest.raises(Ns3Unavailable, match="a C\\+\\+ compiler"):
        building.shim()


def test_what_the_compiler_complains_of_is_shown_and_nothing_is_left(monkeypatch, tmp_path):
    """Libraries without headers, for instance."""
    installed(monkeypatch, without_headers(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    with pytest.raises(Ns3Unavailable, match=r"error-model\.h"):
        building.shim()
    assert not list((tmp_path / "cache" / "sendworthy" / "ns3").iterdir())


def test_where_ns3_is_at_another_place_another_shim_is_compiled(monkeypatch, tmp_path):
    """One finds the libraries only where they were when it was compiled."""
    compiler = tmp_path / "c++"
    compiler.write_text('#!/bin/sh\nwhile [ "$1" != -o ]; do shift; done\necho "$@" > "$2"\n')
    compiler.chmod(0o755)
    monkeypatch.setenv("CXX", str(compiler))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    shims = []
    for name in ("one", "two"):
        root = without_headers(tmp_path / name)
        for _ in range(2):
            installed(monkeypatch, root)
            shims.append(building.shim())
        assert f"-rpath,{root}" in shims[-1].read_text()
    assert shims[0] == shims[1] != shims[2] == shims[3]
