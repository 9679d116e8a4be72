"""The JSON schemas of `cg run` and `cg estimate`, compared with real outputs in both directions."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path

import jsonschema
import pytest
from referencing import Registry, Resource

from conftest import FIXTURES, LOGS, cg

DOCS = FIXTURES.parent / "docs"
SCHEMAS = {
    name: json.loads((DOCS / f"{name}.schema.json").read_text()) for name in ("events", "estimate")
}
REGISTRY = Registry().with_resources(
    (schema["$id"], Resource.from_contents(schema)) for schema in SCHEMAS.values()
)
VALIDATORS = {
    name: jsonschema.Draft202012Validator(schema, registry=REGISTRY)
    for name, schema in SCHEMAS.items()
}
TRUCK, EURO = (FIXTURES / "vehicles" / f"{name}.toml" for name in ("kraz", "euro"))
ROAD = FIXTURES / "roads" / "B_rural_p16_h170.csv.gz"
EMPTY, LADEN = (FIXTURES / "logs" / name for name in ("A_p00_v50_L.csv", "A_p20_h190_v50_L.csv"))


def lines(*command: str | Path, codes: tuple[int, ...] = (0,)) -> list[dict]:
    done = subprocess.run([cg(), *command], capture_output=True, text=True, check=False)
    assert done.returncode in codes, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def joined(path: Path, logs: list[Path]) -> Path:
    """Write one log after the other, with a gap between them."""
    text, origin_s, last_s = [], 0.0, 0.0
    for log in logs:
        header, *rows = [line for line in log.read_text().splitlines() if line[0] != "#"]
        assert header.startswith("time_s,")
        text = text or [header]
        for row in rows:
            time_s, rest = row.split(",", 1)
            last_s = origin_s + float(time_s)
            text.append(f"{last_s:.3f},{rest}")
        origin_s = last_s + 10.0
    path.write_text("\n".join(text) + "\n")
    return path


def lifting(folder: Path) -> Path:
    """Write the truck with a lift axle."""
    truck = folder / "lifting.toml"
    axle = "[[trailer.axle]]\n"
    truck.write_text(TRUCK.read_text().replace(axle, f"{axle}lift_m = 0.1\n", 1))
    return truck


@pytest.fixture(scope="module")
def events(tmp_path_factory) -> list[dict]:
    """Return the events of trips, of a change of the load, of chassis sensors, and of faults."""
    folder = tmp_path_factory.mktemp("schemas")
    run = ["run", "--vehicle", TRUCK]
    kept = ["--state", folder / "state.json"]
    found = lines(*run, "--csv", EMPTY, *kept)
    both = joined(folder / "both.csv", [LADEN, EMPTY, EMPTY])
    found += lines(*run, "--csv", both, "--warn", "0.1", *kept)
    found += lines(*run, "--csv", LADEN, "--trailer-mass-kg", "28684")
    twice = joined(folder / "twice.csv", [LADEN, LADEN])
    found += lines(*run, "--csv", twice, "--speed-request", "0.2", "--status-s", "0.2")
    found += lines(*run, "--csv", LADEN, "--flip", "roll", codes=(1,))
    chassis = folder / "chassis.log"
    simulate = ["simulate", "--vehicle", EURO, "--maneuver", "drive", "--duration-s", "60"]
    lines(*simulate, "-o", chassis)
    found += lines("run", "--vehicle", EURO, "--candump", chassis, codes=(0, 1))
    found += lines("run", "--vehicle", lifting(folder), "--csv", LADEN, codes=(0, 1))
    return found + lines("run", "--vehicle", EURO, "--csv", ROAD)


def test_every_event_is_as_the_schema_says_and_every_kind_occurs(events):
    for line in events:
        # With the schema of the kind, the message says which key is wrong.
        kind = {"$ref": f"events.schema.json#/$defs/{line['event']}"}
        jsonschema.Draft202012Validator(kind, registry=REGISTRY).validate(line)
        VALIDATORS["events"].validate(line)
    # Turns are on the live page only; test_live checks them.
    assert {line["event"] for line in events} == kinds() - {"turn"}


def kinds() -> set[str]:
    return {entry["$ref"].rsplit("/", 1)[1] for entry in SCHEMAS["events"]["oneOf"]}


@pytest.fixture(scope="module")
def answers(tmp_path_factory) -> list[dict]:
    """Return the answers for logs with a height, without one, and with contradicting sensors."""
    estimate = ["estimate", "--vehicle", TRUCK, "--format", "json"]
    truth = ["--truth", FIXTURES / "logs" / "truth.json"]
    paths = [FIXTURES / "logs" / name for name in LOGS]
    found = lines(*estimate, *paths, *truth)
    found += lines(*estimate, LADEN, "--method", "arx", codes=(0, 1))
    found += lines(*estimate, LADEN, "--flip", "roll", codes=(1,))
    straight = tmp_path_factory.mktemp("schemas") / "straight.csv"
    straight.write_text("\n".join(LADEN.read_text().splitlines()[:150]) + "\n")
    found += lines(*estimate, straight, codes=(1,))
    return found + lines("estimate", "--vehicle", EURO, "--format", "json", ROAD, codes=(0, 1))


def test_every_answer_is_as_the_schema_says(answers):
    for line in answers:
        VALIDATORS["estimate"].validate(line)
    assert {line["status"] for line in answers} >= {"ok", "rejected"}


def paths(value: object, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Yield the path of each key in an output; items of arrays have the path of the array."""
    if isinstance(value, dict):
        for key, below in value.items():
            yield (*above, key)
            yield from paths(below, (*above, key))
    elif isinstance(value, list):
        for below in value:
            yield from paths(below, above)


def described(schema: dict, root: dict, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Yield the path of each key in a schema."""
    if reference := schema.get("$ref"):
        file, _, place = reference.partition("#/$defs/")
        root = SCHEMAS[file.removesuffix(".schema.json")] if file else root
        schema = root["$defs"][place]
    for key, below in schema.get("properties", {}).items():
        yield (*above, key)
        yield from described(below, root, (*above, key))
    items = [schema["items"]] if "items" in schema else []
    for part in (*schema.get("allOf", ()), *schema.get("oneOf", ()), *items):
        yield from described(part, root, above)


def test_every_key_of_the_schemas_occurs(events, answers):
    """A key that is described and never written would be a promise that nobody keeps."""
    for kind in kinds() - {"turn"}:
        there = {path for line in events if line["event"] == kind for path in paths(line)}
        wanted = set(described(SCHEMAS["events"]["$defs"][kind], SCHEMAS["events"]))
        # A page is in test_live, a latency in the test on a CAN interface (`make guest`).
        rare = {("page",), *(("latency_ms", name) for name in ("p50", "p99", "greatest"))}
        assert wanted - there <= rare, (kind, wanted - there)
    there = {path for line in answers for path in paths(line)}
    assert set(described(SCHEMAS["estimate"], SCHEMAS["estimate"])) == there


@pytest.mark.parametrize("name", ["events", "estimate"])
def test_the_schemas_refuse_other_keys_missing_keys_and_other_types(name, events, answers):
    jsonschema.Draft202012Validator.check_schema(SCHEMAS[name])
    lines = events if name == "events" else answers
    for kind in {line.get("event") for line in lines}:
        line = max((line for line in lines if line.get("event") == kind), key=len)
        VALIDATORS[name].validate(line)
        optional = {"page", "suspension", "tractor", "trailer_mass_scale", "known_height_m"}
        optional |= {"requested_speed_mps"} if kind == "status" else set()
        optional |= {"lift_axle"} if kind in ("status", "maneuver") else set()
        wrong = [{**line, "other": 1}]
        needed = [key for key in line if key not in optional]
        wrong += [{k: v for k, v in line.items() if k != key} for key in needed]
        wrong += [{**line, key: {"x": 1}} for key in line]
        for one in wrong:
            assert not VALIDATORS[name].is_valid(one), (kind, set(line) ^ set(one))
