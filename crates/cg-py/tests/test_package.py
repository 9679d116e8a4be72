"""The package itself: documentation, version, types, optional parts."""

from __future__ import annotations

import ast
import dataclasses
import doctest
import graphlib
import importlib.resources
import inspect
import pickle
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import is_typeddict

import pytest

import cgheight
from cgheight import _native, can, plot, spark
from conftest import FIXTURES, ONE_TURN

PUBLIC = [name for name in cgheight.__all__ if name != "__version__"]
MODULES = [cgheight, can, plot, spark]
FUNCTIONS = [
    (module, name)
    for module in MODULES
    for name in module.__all__
    if inspect.isroutine(getattr(module, name))
]
CLASSES = [
    (module, name)
    for module in MODULES
    for name in module.__all__
    if inspect.isclass(getattr(module, name))
]
# What the description of a quantity with this suffix must contain.
UNITS = {
    "_m": r"\bm\b",
    "_s": r"\bs\b|seconds",
    "_rad": r"\brad\b|steer",
    "_mps": r"m/s",
    "_mps2": r"m/s²",
    "_radps": r"rad/s",
    "_kg": r"\bkg\b",
    "_db": r"\bdB\b",
    "_hz": r"\bHz\b|per second",
    "_g": r"\bin g\b",
    "_n": r"\bN\b",
    "_nm": r"\bN m\b",
    "_percent": r"%",
}


def fields(thing: type) -> set[str] | None:
    """Return the fields of a class that holds values, and None for other classes."""
    if dataclasses.is_dataclass(thing):
        return {field.name for field in dataclasses.fields(thing)}
    return set(thing.__annotations__) if is_typeddict(thing) else None


def members(thing: object) -> list[tuple[str, object]]:
    return [(name, value) for name, value in vars(thing).items() if not name.startswith("_")]


def sections(text: str) -> dict[str, str]:
    """Return the sections of a numpydoc docstring by their headings."""
    parts = re.split(r"^([A-Z][a-z]+)\n-{4,}\n", inspect.cleandoc(text), flags=re.MULTILINE)
    return dict(zip(["Summary", *parts[1::2]], [parts[0], *parts[2::2]], strict=True))


def entries(section: str) -> dict[str, tuple[str, str]]:
    """Return type and description of each name in a section."""
    found = {}
    for names, kind, description in re.findall(
        r"^(\S[^\n:]*?)(?: : ([^\n]*))?\n((?:[ ]{4}[^\n]*\n?|\n)+)", section, flags=re.MULTILINE
    ):
        for name in names.split(", "):
            found[name.strip("*` ")] = (kind, description)
    return found


def has_units_and_shapes(where: str, documented: dict[str, tuple[str, str]]) -> None:
    for name, (kind, description) in documented.items():
        if "array" in kind and "dict" not in kind:
            assert re.search(r"shape|1-D|one for each axle|shapes", kind + description), (
                where,
                name,
            )
        ending = next((e for e in sorted(UNITS, key=len, reverse=True) if name.endswith(e)), None)
        is_number = re.match(r"(float|array|int|iterable of float)", kind)
        if ending and is_number:
            assert re.search(UNITS[ending], kind + " " + description), (where, name, description)


@pytest.mark.parametrize(
    ("module", "name"), FUNCTIONS, ids=lambda one: getattr(one, "__name__", one)
)
def test_every_function_says_what_goes_in_what_comes_out_and_what_it_raises(module, name):
    thing = getattr(module, name)
    parts = sections(thing.__doc__)
    assert re.match(r"[A-Z][^\n]+\.", parts["Summary"])
    documented = entries(parts["Parameters"])
    parameters = list(inspect.signature(thing).parameters)
    assert set(documented) == set(parameters), name
    has_units_and_shapes(name, documented)
    signature = inspect.signature(thing)
    if signature.return_annotation not in (None, "None"):
        assert parts["Returns"].strip()
    assert re.search(r"(ValueError|OSError|FileNotFoundError|TypeError)", parts["Raises"])


@pytest.mark.parametrize(("module", "name"), CLASSES, ids=lambda one: getattr(one, "__name__", one))
def test_every_class_says_what_it_holds(module, name):
    thing = getattr(module, name)
    # The docstring of a dataclass without one is its signature.
    assert thing.__doc__
    assert not thing.__doc__.startswith(f"{name}(")
    parts = sections(thing.__doc__)
    held = fields(thing)
    if held is not None:
        documented = entries(parts["Attributes"])
        assert held == set(documented)
        has_units_and_shapes(name, documented)
    elif name != "Vehicle":
        assert "Parameters" in parts
        assert "Raises" in parts
    for member in (member for member, _ in members(thing) if member not in (held or ())):
        value = getattr(thing, member)
        text = inspect.getdoc(value)
        assert text, member
        takes = callable(value) and set(inspect.signature(value).parameters) - {"self"}
        if takes and member != "on_message_received":
            # Methods such as to_frame have no parameters and return what their name says.
            assert "Parameters" in text, member
            assert "Returns" in text, member


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_the_examples_run(module, monkeypatch):
    monkeypatch.chdir(FIXTURES.parent)
    inner = [
        value
        for name, value in vars(sys.modules["cgheight"]).items()
        if isinstance(value, ModuleType) and name.startswith("_") and value is not _native
    ]
    of = [module, *inner] if module is cgheight else [module]
    results = [doctest.testmod(one) for one in of]
    assert sum(result.failed for result in results) == 0
    if module in (cgheight, can):
        assert sum(result.attempted for result in results) >= 5


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
    for module in MODULES:
        in_order = sorted(module.__all__, key=lambda name: (not name.isupper(), name))
        assert in_order == module.__all__
    contract = {"Vehicle", "estimate", "estimate_log", "Estimator", "arx", "linear_model",
                "simulate", "calibrate", "reproduce"}  # fmt: skip
    assert contract <= set(PUBLIC)
    assert {"HeightListener", "read_log"} <= set(can.__all__)


WITHOUT = """
import sys
class Refuse:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {absent!r}:
            raise ImportError(f"No module named {{name!r}}")
sys.meta_path.insert(0, Refuse())
import cgheight
truck = cgheight.Vehicle.load({vehicle!r})
lag = cgheight.TransferFunction.from_polynomials([1], [1, 1])
print(cgheight.estimate_log({log!r}, vehicle=truck).status)
try:
    {call}
except ImportError as error:
    print(error)
"""
EXTRAS = [
    ("matplotlib", "plot", "cgheight.plot.bode(lag)"),
    ("can", "can", "cgheight.can"),
    ("control", "control", "lag.to_control()"),
    ("pandas", "pandas", "cgheight.reproduce('5.17')"),
    ("scipy", "identify", "cgheight.arx([0, 1, 0, 2, 1], [0, 1, 2, 2, 4], 1, 1, 0, 1).step()"),
    ("tqdm", "progress", "cgheight.estimate_logs([], vehicle=truck, progress=True)"),
]


@pytest.mark.parametrize(
    ("package", "extra", "call"), EXTRAS, ids=[extra for _, extra, _ in EXTRAS]
)
def test_numpy_alone_is_enough_and_a_missing_extra_is_named(package, extra, call):
    vehicle = str(FIXTURES / "vehicles" / "kraz.toml")
    program = WITHOUT.format(
        absent={one for one, _, _ in EXTRAS} | {"polars", "pyspark", "pyarrow"},
        log=str(FIXTURES / "logs" / "A_p10_h170_v50_L.csv"),
        vehicle=vehicle,
        call=call,
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    status, message = done.stdout.splitlines()
    assert status == "ok"
    assert message == (
        f"this needs {package}, which is not installed: pip install 'cgheight[{extra}]'"
    )


def test_vehicles_pickle_with_their_calibration(kraz, tmp_path):
    log = FIXTURES / "logs" / "A_p20_h190_v50_L.csv"
    truck = cgheight.calibrate(kraz, [(log, 1.9)], tmp_path / "truck.toml")
    for one in (kraz, truck):
        again = pickle.loads(pickle.dumps(one))
        assert repr(again) == repr(one)
        expected = cgheight.estimate_log(log, vehicle=one)
        assert cgheight.estimate_log(log, vehicle=again) == expected


def test_no_function_has_more_than_ten_parameters():
    seen = 0
    for module in MODULES:
        for name in module.__all__:
            thing = getattr(module, name)
            callables = [(name, thing)] if inspect.isroutine(thing) else []
            if inspect.isclass(thing):
                callables = [member for member in members(thing) if callable(member[1])]
                # The parameters of an option object or a result are its fields.
                if fields(thing) is None:
                    callables.append((name, thing))
            for called, function in callables:
                parameters = inspect.signature(function).parameters
                assert len(parameters) <= 10, (called, list(parameters))
                seen += 1
    assert seen > 40


def imported(path, modules):
    """Return the modules of the package that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                below = f"{node.module}.{alias.name}"
                # The compiled module has no source file in the package.
                found |= {below if below in modules else node.module} - {
                    node.module if alias.name == "_native" else None
                }
    return found & modules


def test_the_modules_of_the_package_use_each_other_one_way():
    root = Path(cgheight.__file__).parent
    names = {}
    for path in root.rglob("*.py"):
        parts = path.relative_to(root.parent).with_suffix("").parts
        names[".".join(parts).removesuffix(".__init__")] = path
    arrows = {name: imported(path, set(names)) for name, path in names.items()}
    assert sum(map(len, arrows.values())) > 40
    # Raises a CycleError that names the cycle, if there is one.
    graphlib.TopologicalSorter(arrows).prepare()


def test_an_estimate_of_many_is_an_estimate(kraz):
    many = cgheight.estimate_logs([FIXTURES / "logs" / ONE_TURN] * 2, vehicle=kraz)
    assert type(many[0]) is cgheight.Estimate
    assert many[-1].height_m == many[0].height_m > 0
    assert many[:1] == (many[0],)
    assert len(many.to_frame()) == len(many) == 2


def test_every_option_that_a_message_names_is_a_keyword():
    sources = Path(__file__).parents[2]
    text = "".join(path.read_text() for path in sources.glob("cg-*/src/**/*.rs"))
    named = set(re.findall("\u27e8([a-z0-9_]+)", text)) - {"flip_roll"}
    assert len(named) > 15
    keywords = set()
    for module in MODULES:
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isroutine(thing) or (inspect.isclass(thing) and not is_typeddict(thing)):
                keywords |= set(inspect.signature(thing).parameters)
            if thing is cgheight.Plant:
                keywords |= set(inspect.signature(thing.step).parameters)
    # `source_of` exists on the command line only.
    # Messages name roads as `Vehicle.on_road`; the keyword `road` is that of `Scenario`.
    # So does the position of lift axles, `Vehicle.with_lift_axle`; `lift_axle` is that of results.
    assert named - keywords == {"source_of"}
    assert callable(cgheight.Vehicle.on_road)
    assert callable(cgheight.Vehicle.with_lift_axle)
