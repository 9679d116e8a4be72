"""The FMUs of plant and estimator in FMPy, a simulation tool that shares nothing with them."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest

from cgheight import Estimator, Plant
from conftest import FIXTURES, cg, read

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # of the packages that FMPy imports
    import fmpy
    from fmpy.fmi1 import FMICallException
    from fmpy.fmi3 import FMU3Slave
    from fmpy.validation import validate_fmu

KRAZ = FIXTURES / "vehicles" / "kraz.toml"
BASELINE = FIXTURES / "vehicles" / "baseline.toml"


def command(*arguments: object) -> str:
    """Run `cg` and return what it prints."""
    words = [cg(), *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def made(folder: Path, kind: str, vehicle: Path = KRAZ) -> Path:
    """Return the FMU of a vehicle."""
    path = folder / f"{kind}.fmu"
    command("fmu", "--vehicle", vehicle, "--kind", kind, "-o", path)
    return path


class _Fmu:
    """An FMU that has been unpacked, of which instances are made."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.model = fmpy.read_model_description(path)
        self.folder = fmpy.extract(path)
        self.by_name = {variable.name: variable for variable in self.model.modelVariables}

    def instance(self) -> _Instance:
        return _Instance(self)

    def names(self, causality: str) -> list[str]:
        return [name for name, one in self.by_name.items() if one.causality == causality]


class _Instance:
    """An instance with variables by name, which keeps what the FMU reports."""

    def __init__(self, fmu: _Fmu) -> None:
        self.fmu, self.said = fmu, []
        self.slave = FMU3Slave(
            guid=fmu.model.guid,
            unzipDirectory=fmu.folder,
            modelIdentifier=fmu.model.coSimulation.modelIdentifier,
            instanceName="one",
        )
        self.slave.instantiate(
            loggingOn=True,
            logMessage=lambda _, status, category, text: self.said.append(
                (status, category.decode(), text.decode())
            ),
        )

    def start(self, start_s: float = 0.0, **values: float) -> _Instance:
        self.set(**values)
        self.slave.enterInitializationMode(startTime=start_s)
        self.slave.exitInitializationMode()
        return self

    def reference(self, name: str) -> int:
        return self.fmu.by_name[name].valueReference

    def set(self, **values: float) -> None:
        self.slave.setFloat64([self.reference(name) for name in values], list(values.values()))

    def get(self, *names: str) -> np.ndarray:
        return np.array(self.slave.getFloat64([self.reference(name) for name in names]))

    def free(self) -> None:
        self.slave.freeInstance()


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmus")
    both = {kind: _Fmu(made(folder, kind)) for kind in ("plant", "estimator")}
    yield both
    for fmu in both.values():
        shutil.rmtree(fmu.folder)


def check_description(path: Path) -> None:
    assert validate_fmu(str(path)) == []
    model = fmpy.read_model_description(path)
    assert model.fmiVersion == "3.0"
    units = {unit.name for unit in model.unitDefinitions}
    for variable in model.modelVariables:
        assert variable.description, variable.name
        is_quantity = variable.type == "Float64" and variable.name != "load_transfer_ratio"
        assert (variable.unit in units) == is_quantity, variable.name


def test_the_model_descriptions_are_valid(fmus, tmp_path):
    for fmu in fmus.values():
        check_description(fmu.path)
    # Other axles and sensors.
    check_description(made(tmp_path, "plant", BASELINE))


def test_equal_inputs_give_equal_bytes_and_no_foreign_file_is_replaced(fmus, tmp_path):
    own = tmp_path / "estimator.fmu"
    command("fmu", "--vehicle", KRAZ, "--kind", "estimator", "-o", own)
    assert own.read_bytes() == fmus["estimator"].path.read_bytes()
    foreign = tmp_path / "foreign.fmu"
    foreign.write_bytes(b"PK\x03\x04 of another program")
    words = [cg(), "fmu", "--vehicle", KRAZ, "--kind", "estimator", "-o", foreign]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "foreign.fmu" in done.stderr
    assert foreign.read_bytes() == b"PK\x03\x04 of another program"


@pytest.mark.parametrize(
    "log", ["A_p20_h190_v50_L.csv", "C_p15_h185_v50_R.csv", "F_drive1_p15_h155.csv.gz"]
)
def test_the_estimator_gives_the_height_of_cg_estimate(log, fmus):
    path = FIXTURES / "logs" / log
    known = json.loads(command("estimate", path, "--vehicle", KRAZ, "--format", "json"))
    assert known["status"] == "ok"
    rows = read(log)
    time_s = rows["time_s"]
    names = [name for name in rows if name in fmus["estimator"].by_name]
    assert len(names) == len(rows) - 1  # all but the time
    one = fmus["estimator"].instance().start(float(time_s[0]))
    # A row is the input at its time; the last one needs a step too.
    steps_s = np.diff(time_s, append=time_s[-1] + 0.01)
    table = np.column_stack([rows[name] for name in names])
    for now_s, step_s, row in zip(time_s, steps_s, table, strict=True):
        one.set(**dict(zip(names, row, strict=True)))
        one.slave.doStep(float(now_s), float(step_s))
    height_m, sd_m, low_m, high_m = one.get(
        "height_m", "height_sd_m", "height_low_m", "height_high_m"
    )
    # The same arithmetic; the margin is for a compiler that orders it otherwise.
    assert height_m == pytest.approx(known["height_m"], abs=1e-9)
    assert sd_m == pytest.approx(known["height_sd_m"], abs=1e-9)
    assert [low_m, high_m] == pytest.approx(known["height_ci95_m"], abs=1e-9)
    ok = 1
    assert one.slave.getInt64([one.reference("status"), one.reference("maneuvers")]) == [
        ok,
        len(known["maneuvers"]),
    ]
    one.slave.terminate()
    # What `cg estimate` says about the log goes to the logger of the tool, which has no flags.
    said = [re.sub(r"`road (\w+)`", r"--road \1", text) for *_, text in one.said]
    assert said == known["messages"]
    one.free()


def simulated(folder: Path, *arguments: object) -> dict[str, np.ndarray]:
    """Return a log of `cg simulate` with the nonlinear plant."""
    path = folder / "log.csv"
    command("simulate", "--vehicle", KRAZ, *arguments, "-o", path)
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    table = np.genfromtxt(lines, delimiter=",", names=True)
    return {column: table[column] for column in table.dtype.names}


def test_the_plant_drives_as_cg_simulate(fmus, tmp_path):
    # At the rate of the plant's steps, so that the steer angle between two rows is the same too.
    log = simulated(
        tmp_path,
        *("--maneuver", "drive", "--plant", "nonlinear", "--rate-hz", 1000, "--duration-s", 8),
        *("--height-m", 1.9, "--payload-kg", 12e3, "--payload-left-m", 0.1, "--seed", 4),
    )
    time_s = log.pop("time_s")
    one = fmus["plant"].instance()
    load = {"height_m": 1.9, "payload_kg": 12e3, "payload_left_m": 0.1}
    one.start(speed_demand_mps=log["speed_mps"][0], **load)
    driven = [one.get(*log)]
    for k in range(1, len(time_s)):
        one.set(steer_demand_rad=log["steer_rad"][k], speed_demand_mps=log["speed_mps"][k])
        one.slave.doStep(time_s[k - 1], time_s[k] - time_s[k - 1])
        driven.append(one.get(*log))
    one.free()
    assert np.ptp(log["steer_rad"]) > 0.02  # it turns
    assert np.ptp(log["speed_mps"]) > 0.1
    for name, values in zip(log, np.array(driven).T, strict=True):
        assert np.max(np.abs(values - log[name])) <= 1e-9, name


def test_every_input_and_parameter_is_that_of_its_name(fmus, kraz):
    """Each has a value of its own, so that two that are crossed give another drive."""
    load = {
        "payload_kg": 12e3,
        "height_m": 1.9,
        "payload_behind_hitch_m": 5.5,
        "payload_left_m": 0.1,
    }
    start = {"bank_rad": 0.01, "grade_rad": -0.03}
    later = {"bank_rad": -0.02, "grade_rad": 0.04}
    assert [*load] == fmus["plant"].names("parameter")
    assert ["steer_demand_rad", "speed_demand_mps", *start] == fmus["plant"].names("input")
    one = fmus["plant"].instance().start(**load, **start, speed_demand_mps=12.0)
    plant = Plant(kraz, **load, **start, speed_mps=12.0)
    columns = [name for name in plant.states if name in fmus["plant"].by_name]
    assert len(columns) > 30
    for k in range(1, 200):
        steer_rad, speed_mps = 2e-4 * k, 12.0 + 0.01 * k
        one.set(steer_demand_rad=steer_rad, speed_demand_mps=speed_mps, **later)
        one.slave.doStep((k - 1) / 100, 0.01)
        plant.step(steer_rad, 0.01, speed_mps=speed_mps, **later)
        # Rounding: the times of the FMU are multiples of the step, those of the plant a sum.
        expected = [plant.states[name] for name in columns]
        assert one.get(*columns) == pytest.approx(expected, rel=1e-9, abs=1e-9), k
    assert plant.states["tractor_roll_rad"] != pytest.approx(0.0, abs=1e-3)
    one.free()


def turn(now_s: float) -> float:
    """Return the steer angle of a turn to the left that begins at 3 s and ends at 12 s."""
    return float(np.interp(now_s, [3.0, 4.0, 12.0, 13.0], [0.0, 0.03, 0.03, 0.0]))


def test_wired_together_they_find_the_height(fmus, kraz):
    load = {"height_m": 1.9, "payload_kg": 15e3}
    plant = fmus["plant"].instance().start(**load)
    estimator = fmus["estimator"].instance().start()
    wires = [name for name in fmus["estimator"].names("input") if name in fmus["plant"].by_name]
    assert len(wires) > 10
    in_python = Plant(kraz, **load), Estimator(kraz)
    for k in range(2000):
        now_s = k / 100
        in_python[1].push(**in_python[0].signals)
        in_python[0].step(turn(now_s + 0.01), 0.01)
        estimator.set(**dict(zip(wires, plant.get(*wires), strict=True)))
        plant.set(steer_demand_rad=turn(now_s + 0.01))
        plant.slave.doStep(now_s, 0.01)
        estimator.slave.doStep(now_s, 0.01)
    height_m, low_m, high_m, margin_mps2, limit_mps2 = estimator.get(
        *("height_m", "height_low_m", "height_high_m"),
        *("margin_mps2", "static_rollover_threshold_mps2"),
    )
    # Rounding: the times of the FMU are multiples of the step, those of the plant a sum.
    assert height_m == pytest.approx(in_python[1].estimate().height_m, abs=1e-9)
    assert low_m < load["height_m"] < high_m
    # It knows more than the file, which says only within which range the height is.
    lowest_m, highest_m = kraz.height_range_m
    assert high_m - low_m < (highest_m - lowest_m) / 2
    assert abs(height_m - load["height_m"]) < (high_m - low_m) / 2
    # It drives straight at the end, so all of the threshold is left.
    assert margin_mps2 == pytest.approx(limit_mps2, abs=0.05)
    assert [said for said in plant.said + estimator.said if said[0] > 1] == []
    plant.free()
    estimator.free()


def test_steps_of_any_length_give_the_same_drive(fmus):
    """The internal step, a whole part of 10 ms, does not depend on longer communication steps."""
    ends = []
    for step_s in (0.01, 0.05, 0.5, 0.002):
        one = fmus["plant"].instance().start()
        one.set(steer_demand_rad=0.02)
        one.slave.doStep(0.0, 0.5)
        for k in range(round(1.0 / step_s)):
            one.slave.doStep(0.5 + k * step_s, step_s)
        ends.append(one.get("roll_rad", "trailer_yaw_rad", "position_y_m", "time"))
        one.free()
    # Rounding of the step lengths in a thousand steps.
    assert np.allclose(ends[:3], ends[0], rtol=0, atol=1e-9)
    # A shorter one divides the internal step further, and drives as exactly as docs/plant.md says.
    assert np.allclose(ends[3], ends[0], rtol=1e-6, atol=0)


def test_instances_are_independent_and_can_be_reset_and_kept(fmus):
    def run(one: _Instance, steps: int, first: int = 0) -> np.ndarray:
        for k in range(first, first + steps):
            one.set(steer_demand_rad=turn(3.0 + k / 10))
            one.slave.doStep(k / 10, 0.1)
        return one.get("roll_rad", "yaw_rate_radps", "trailer_mass_kg")

    one = fmus["plant"].instance().start(payload_kg=5e3)
    other = fmus["plant"].instance().start(payload_kg=15e3)
    halfway = run(one, 10)
    alone = run(other, 20)
    kept = one.slave.getFMUState()
    light = run(one, 10, first=10)
    assert light[2] + 10e3 == pytest.approx(alone[2])
    assert np.all(np.abs(light[:2] - alone[:2]) > 1e-3)
    # Back to the middle, and on again: to the last bit.
    one.slave.setFMUState(kept)
    one.slave.freeFMUState(kept)
    assert np.array_equal(one.get("roll_rad", "yaw_rate_radps", "trailer_mass_kg"), halfway)
    assert np.array_equal(run(one, 10, first=10), light)
    # After a reset it has the start values again, not those of before.
    one.slave.reset()
    one.start()
    assert one.get("payload_kg") == float(fmus["plant"].by_name["payload_kg"].start)
    one.slave.reset()
    one.start(payload_kg=15e3)
    assert np.array_equal(run(one, 20), alone)
    one.free()
    # The other one still works.
    run(other, 1, first=20)
    other.free()


def test_a_vehicle_that_rolls_over_ends_the_simulation(fmus):
    one = fmus["plant"].instance().start(height_m=2.4, speed_demand_mps=20.0)
    one.set(steer_demand_rad=0.1)
    ends = [one.slave.doStep(k / 10, 0.1)[1] for k in range(100)]
    assert ends.count(True) == 1  # told once
    assert one.slave.getBoolean([one.reference("rolled_over")]) == [True]
    (said,) = one.said
    assert said[1] == "logStatusWarning"
    assert "rolled over" in said[2]
    one.free()


@pytest.mark.parametrize(
    ("kind", "start", "now", "message"),
    [
        ("plant", {"height_m": 9.0}, {}, "9"),
        ("plant", {"payload_kg": -5e4}, {}, "mass"),
        ("plant", {"speed_demand_mps": 0.0}, {}, "speed_demand_mps 0 must be positive"),
        ("plant", {"bank_rad": 2.0}, {}, "bank_rad 2 must lie between -0.5 and 0.5"),
        ("plant", {}, {"steer_demand_rad": float("nan")}, "steer_demand_rad NaN must lie"),
        ("plant", {}, {"payload_kg": 1e3}, "payload_kg cannot be set: only steps"),
        ("plant", {}, {"roll_rad": 0.1}, "roll_rad cannot be set: it is an output"),
        ("estimator", {"trailer_mass_sd_kg": -1.0}, {}, "trailer_mass_sd_kg -1 must be zero or"),
        ("estimator", {"road_bank_sd_rad": 9.0}, {}, "road_bank_sd_rad 9: "),
        ("estimator", {}, {"roll_rad": float("inf")}, "roll_rad inf at 0 s is not finite"),
    ],
)
def test_bad_input_is_reported_through_the_logger(fmus, kind, start, now, message):
    one = fmus[kind].instance()

    def go() -> None:
        one.start(**start)
        one.set(**now)
        one.slave.doStep(0.0, 0.1)

    with pytest.raises(FMICallException):
        go()
    (said,) = one.said
    error = 3
    assert said[:2] == (error, "logStatusError")
    assert message in said[2]
    # The instance is not broken by it.
    one.slave.reset()
    one.start()
    one.slave.doStep(0.0, 0.1)
    one.free()


def test_calls_in_a_wrong_order_are_errors(fmus):
    one = fmus["plant"].instance()
    for wrong, why in [
        (lambda: one.slave.doStep(0.0, 0.1), "enter the initialization mode first"),
        (lambda: one.get("roll_rad"), "outputs cannot be read"),
        (lambda: one.slave.setFloat64([9999], [1.0]), "value reference 9999"),
        (lambda: one.slave.getBoolean([one.reference("payload_kg")]), "no variable of this type"),
    ]:
        with pytest.raises(FMICallException):
            wrong()
        assert why in one.said[-1][2]
    one.start()
    for from_s, step_s, why in [(1.0, 0.1, "begins at 1 s"), (0.0, 0.0, "must be positive")]:
        with pytest.raises(FMICallException):
            one.slave.doStep(from_s, step_s)
        assert why in one.said[-1][2]
    one.free()


def test_changed_resources_are_refused(fmus, tmp_path):
    fmu = fmus["estimator"]
    folder = shutil.copytree(fmu.folder, tmp_path / "changed")
    file = folder / "resources" / "vehicle.toml"
    file.write_text(file.read_text() + "# changed\n")
    said = []
    slave = FMU3Slave(
        guid=fmu.model.guid,
        unzipDirectory=folder,
        modelIdentifier=fmu.model.coSimulation.modelIdentifier,
        instanceName="one",
    )
    with pytest.raises(Exception, match="Failed to instantiate"):
        slave.instantiate(logMessage=lambda *words: said.append(words[3].decode()))
    assert "make it again with cg fmu" in said[0]


def test_a_tool_simulates_it_as_it_is(fmus):
    """FMPy's own algorithm, with the defaults of the model description."""
    steer = np.array(
        [(0.0, 0.0), (1.0, 0.02), (5.0, 0.02)],
        dtype=[("time", float), ("steer_demand_rad", float)],
    )
    result = fmpy.simulate_fmu(
        str(fmus["plant"].path),
        stop_time=5.0,
        input=steer,
        output=["roll_rad", "load_transfer_ratio", "rolled_over"],
    )
    assert result["time"][-1] == pytest.approx(5.0)
    assert result["roll_rad"][0] == pytest.approx(0.0, abs=1e-9)
    # A left turn: the right side goes down and is loaded.
    assert result["roll_rad"][-1] > 1e-3
    assert result["load_transfer_ratio"][-1] > 1e-3
    assert not result["rolled_over"].any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--kind", "plant", "--library", KRAZ], "kraz.toml: not a shared library; give the"),
        (["--kind", "estimator", "--calibration", BASELINE], "baseline.toml: "),
        (["--kind", "plant", "--calibration", BASELINE], "the plant has no use for it"),
    ],
)
def test_a_file_that_does_not_fit_is_named(arguments, message, tmp_path):
    words = [cg(), "fmu", "--vehicle", KRAZ, *arguments, "-o", tmp_path / "x.fmu"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert message in done.stderr
    assert not (tmp_path / "x.fmu").exists()


def test_without_a_library_it_says_how_to_get_one(tmp_path):
    alone = tmp_path / "cg"
    shutil.copy(cg(), alone)
    words = [alone, "fmu", "--vehicle", KRAZ, "--kind", "plant", "-o", tmp_path / "x.fmu"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "libcg_fmi.so, which an FMU contains; build it with" in done.stderr
    assert not (tmp_path / "x.fmu").exists()
