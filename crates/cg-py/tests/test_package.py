"""The package itself: documentation, version, types."""

from __future__ import annotations

import dataclasses
import doctest
import importlib.resources
import inspect

import pytest

import cgheight
from cgheight import _native
from conftest import FIXTURES

PUBLIC = [name for name in cgheight.__all__ if name != "__version__"]


def members(thing: object) -> list[tuple[str, object]]:
    return [(name, value) for name, value in vars(thing).items() if not name.startswith("_")]


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_is_documented(name):
    thing = getattr(cgheight, name)
    # A dataclass without a docstring gets its signature as one.
    assert thing.__doc__
    assert not thing.__doc__.startswith(f"{name}(")
    if dataclasses.is_dataclass(thing):
        for field in dataclasses.fields(thing):
            assert field.name in thing.__doc__
    elif not inspect.isclass(thing):
        for parameter in inspect.signature(thing).parameters:
            assert parameter in thing.__doc__
        assert "Returns" in thing.__doc__
        assert "Raises" in thing.__doc__
    if inspect.isclass(thing):
        for member, value in members(thing):
            documented = value.__doc__ if not dataclasses.is_dataclass(thing) else None
            is_field = dataclasses.is_dataclass(thing) and not inspect.isfunction(value)
            assert is_field or inspect.getdoc(value) or documented, member


def test_the_example_runs(monkeypatch):
    monkeypatch.chdir(FIXTURES.parent)
    failed, attempted = doctest.testmod(cgheight)
    assert (failed, attempted) == (0, 4)


def test_the_compiled_half_is_documented_too():
    for name, thing in members(_native):
        assert thing.__doc__, name
    for name in ("push", "estimate"):
        assert getattr(cgheight.Estimator, name).__doc__


def test_version_and_types_are_there():
    assert cgheight.__version__ == _native.__version__
    assert cgheight.__version__.count(".") == 2
    files = {entry.name for entry in importlib.resources.files("cgheight").iterdir()}
    assert {"py.typed", "_native.pyi", "__init__.py"} <= files


def test_the_public_names_are_sorted_and_there():
    assert sorted(PUBLIC) == PUBLIC
    contract = {"Vehicle", "estimate", "estimate_log", "Estimator", "arx", "linear_model"}
    assert contract <= set(PUBLIC)
