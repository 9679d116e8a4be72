"""Vehicle files: templates, changes, schema."""

from __future__ import annotations

import json
import pickle
import subprocess
import tomllib

import jsonschema
import numpy as np
import pandas as pd
import pytest

import cgheight
from conftest import FIXTURES, cg

KINDS = ["4x2-3axle", "6x4-2axle", "6x4-3axle"]
SCHEMA = json.loads((FIXTURES.parent / "docs" / "vehicle.schema.json").read_text())
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
FILES = sorted((FIXTURES / "vehicles").glob("*.toml"))


@pytest.fixture
def truck() -> cgheight.Vehicle:
    return cgheight.Vehicle.template("4x2-3axle")


@pytest.mark.parametrize("kind", KINDS)
def test_a_template_is_the_file_of_the_command_line(kind, tmp_path):
    path = tmp_path / "truck.toml"
    subprocess.run([cg(), "vehicle", "new", "--kind", kind, "-o", path], check=True)
    truck = cgheight.Vehicle.template(kind)
    assert truck.toml == path.read_text()
    assert truck.name == cgheight.Vehicle.load(path).name


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_truck_gives_a_height(kind):
    truck = cgheight.Vehicle.template(kind).with_({"trailer.payload.floor_height_m": 1.3})
    log = cgheight.simulate(truck, cgheight.Scenario(maneuver="drive", height_m=2.1))
    answer = cgheight.estimate(**log.signals, vehicle=truck)
    # The linear plant has the equations of the design, and the sensors have no errors.
    assert answer.height_m == pytest.approx(2.1, rel=0.01)


def test_the_example_of_the_page_writes_a_vehicle_file(tmp_path, monkeypatch):
    page = (FIXTURES.parent / "docs" / "vehicle.md").read_text()
    monkeypatch.chdir(tmp_path)
    exec(page.split("```python\n")[1].split("```")[0], {})
    truck = cgheight.Vehicle.load("truck-7.toml")
    assert truck.name == "truck 7"
    assert truck.empty_trailer_mass_kg == 4800.0 + 3 * 750.0


def test_an_unknown_kind_lists_those_there_are():
    with pytest.raises(ValueError, match='kind is "8x4": it must be "4x2-3axle", "6x4-2axle" or'):
        cgheight.Vehicle.template("8x4")


def test_values_change_by_path_by_dict_and_by_keyword(truck):
    changed = truck.with_(
        {"trailer.axle[2].spring_spread_m": np.float64(1.3), "trailer.reference_mass_kg": 30000},
        name="truck 7",
        trailer={"tare": {"sprung_mass_kg": np.float32(4800.0)}},
        road={"bank_sd_rad": 0.01},
    )
    old, new = tomllib.loads(truck.toml), tomllib.loads(changed.toml)
    assert changed.name == "truck 7"
    assert changed.reference_trailer_mass_kg == 30000.0
    assert changed.empty_trailer_mass_kg == truck.empty_trailer_mass_kg + 400.0
    old["name"] = "truck 7"
    old["road"] = {"bank_sd_rad": 0.01}
    old["trailer"]["reference_mass_kg"] = 30000
    old["trailer"]["tare"]["sprung_mass_kg"] = 4800.0
    old["trailer"]["axle"][2]["spring_spread_m"] = 1.3
    assert new == old
    assert truck.name != "truck 7"


def test_a_change_is_checked_like_a_file(truck):
    with pytest.raises(ValueError, match=r"with changes:\d+:\d+: trailer\.payload\.width_m = 2480"):
        truck.with_({"trailer.payload.width_m": 2480.0})
    with pytest.raises(ValueError, match="unknown field `paint`"):
        truck.with_(paint="red")
    with pytest.raises(ValueError, match=r"tractor\.axle\[4\]\.steered"):
        truck.with_({"tractor.axle[4].steered": True})
    with pytest.raises(ValueError, match=r"trailer\.payload\.width_m is None"):
        truck.with_({"trailer.payload.width_m": None})
    with pytest.warns(UserWarning, match="nominal_speed_mps = 2: is unusually small"):
        truck.with_(nominal_speed_mps=2)


def test_a_changed_vehicle_keeps_its_roads_and_is_pickled(truck):
    changed = truck.on_road("flat").with_({"tractor.cg_height_m": 1.15})
    assert tomllib.loads(changed.toml)["road"] == {"bank_sd_rad": 0.0}
    again = pickle.loads(pickle.dumps(changed))
    assert again.toml == changed.toml
    assert tomllib.loads(again.toml)["tractor"]["cg_height_m"] == 1.15


def test_a_lift_axle_is_where_the_log_or_the_vehicle_says(truck, tmp_path):
    lifting = truck.with_({"trailer.axle[0].lift_m": 0.1})
    raised = lifting.with_lift_axle("raised")
    assert (lifting.lift_axle, raised.lift_axle) == (None, "raised")
    assert raised.reference_height_m < lifting.reference_height_m
    assert raised.empty_trailer_mass_kg == pytest.approx(lifting.empty_trailer_mass_kg)
    again = pickle.loads(pickle.dumps(raised))
    assert (again.lift_axle, again.height_range_m) == ("raised", raised.height_range_m)
    assert again.with_(nominal_speed_mps=15.0).lift_axle == "raised"
    turn = cgheight.Scenario("rounded-step", plant="nonlinear", trailer_mass_kg=16e3, height_m=1.8)
    empty = cgheight.Scenario("rounded-step", plant="nonlinear", trailer_mass_kg=6650.0)
    log = cgheight.simulate(raised, turn).signals
    assert set(log["lift_axle_raised"]) == {1.0}
    one = cgheight.estimate_log(log, vehicle=lifting)
    # Without noise, the plant's tires and dampers are what the model does not have.
    assert one.height_m == pytest.approx(1.8, rel=0.01)
    assert one.lift_axle == "raised"
    assert ">raised</td>" in one._repr_html_()
    assert not any("lift axle" in message for message in one.messages)
    # As pandas writes and stores true and false.
    frame = pd.DataFrame({**log, "lift_axle_raised": True})
    frame.to_csv(tmp_path / "log.csv", index=False)
    frame.to_parquet(tmp_path / "log.parquet")
    for form in (frame, tmp_path / "log.csv", tmp_path / "log.parquet"):
        read = cgheight.estimate_log(form, vehicle=lifting)
        assert read.height_m == pytest.approx(one.height_m, rel=1e-9)
    frame.assign(roll_rad=True).to_parquet(tmp_path / "log.parquet")
    with pytest.raises(ValueError, match="`roll_rad`: contains BOOLEAN instead of numbers"):
        cgheight.estimate_log(tmp_path / "log.parquet", vehicle=lifting)
    # Channels of different rasters: the mass of a scale is that of the axles that are left.
    rolls = frame[["time_s", "roll_rad"]]
    apart = frame.drop(columns=["trailer_mass_kg", "roll_rad"])
    apart = apart.assign(trailer_axle_load_kg=9e3, time_s=frame["time_s"] + 0.002)
    apart = pd.concat([rolls, apart]).sort_values("time_s")
    apart.to_csv(tmp_path / "apart.csv", index=False)
    forms = (apart, tmp_path / "apart.csv")
    masses_kg = {cgheight.estimate_log(form, vehicle=lifting).trailer_mass_kg for form in forms}
    down = apart.drop(columns="lift_axle_raised")
    assert len(masses_kg) == 1
    assert masses_kg != {cgheight.estimate_log(down, vehicle=lifting).trailer_mass_kg}
    del log["lift_axle_raised"]
    given = cgheight.estimate_log(log, vehicle=raised)
    assert (given.height_m, given.lift_axle) == (one.height_m, "raised")
    without = cgheight.estimate_log(log, vehicle=truck)
    assert without.lift_axle is None
    assert "lift axle" not in without._repr_html_()
    # A prediction follows the log, too: the signs and sizes are those of the measured turn.
    raised_log = {**log, "lift_axle_raised": np.ones(len(log["time_s"]))}
    peak = max(cgheight.predict_roll(raised_log, vehicle=lifting, height_m=1.8))
    assert peak == max(cgheight.predict_roll(log, vehicle=raised, height_m=1.8))
    assert peak > 1.12 * max(cgheight.predict_roll(log, vehicle=lifting, height_m=1.8))
    unknown = cgheight.estimate_log(log, vehicle=lifting)
    assert unknown.height_m > 1.12 * 1.8
    assert unknown.lift_axle == "down"
    assert any("or give vehicle.with_lift_axle" in message for message in unknown.messages)
    empty_log = cgheight.simulate(raised, empty).signals
    calibration = cgheight.calibrate(lifting, [(empty_log, "empty")], tmp_path / "c.toml")
    assert calibration.is_calibrated
    assert len(json.loads(cgheight.learn_log(empty_log, vehicle=lifting))["trips"]) == 1
    del empty_log["lift_axle_raised"]
    assert json.loads(cgheight.learn_log(empty_log, vehicle=lifting))["trips"] == []
    with pytest.raises(ValueError, match='position is "up": it must be "down" or "raised"'):
        lifting.with_lift_axle("up")
    with pytest.raises(ValueError, match="no lift axle to raise"):
        truck.with_lift_axle("raised")


def test_a_calibration_belongs_to_the_unchanged_vehicle(kraz, tmp_path):
    log = FIXTURES / "logs" / "A_p10_h170_v50_L.csv"
    cgheight.calibrate(kraz, [(log, 1.7)], tmp_path / "c.toml")
    calibrated = kraz.calibrated(tmp_path / "c.toml")
    assert calibrated.is_calibrated
    assert not calibrated.with_(name="other").is_calibrated


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_schema_accepts_every_vehicle_file(path):
    VALIDATOR.validate(tomllib.loads(path.read_text()))


@pytest.mark.parametrize("kind", KINDS)
def test_the_schema_refuses_what_the_check_refuses(kind):
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    whole = tomllib.loads(cgheight.Vehicle.template(kind).toml)
    VALIDATOR.validate(whole)
    for table, key, value, message in [
        ("payload", "width_m", 2480.0, "2480.0 is greater than the maximum"),
        ("payload", "width", 2.4, "'width' was unexpected"),
        ("tare", "cg_height_m", "high", "'high' is not of type 'number'"),
        ("tare", "cg_height_m", None, "'cg_height_m' is a required property"),
    ]:
        root = tomllib.loads(cgheight.Vehicle.template(kind).toml)
        if value is None:
            del root["trailer"][table][key]
        else:
            root["trailer"][table][key] = value
        with pytest.raises(jsonschema.ValidationError, match=message):
            VALIDATOR.validate(root)
