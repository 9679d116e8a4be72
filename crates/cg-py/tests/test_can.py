"""CAN logs of every format, with and without a DBC file, and a live bus."""

from __future__ import annotations

import json
import logging
import re
import subprocess
import time
import tomllib

import asammdf
import can
import numpy as np
import pytest

import cgheight
from cgheight import Scenario, Sensors
from cgheight.can import HeightListener, read_log
from conftest import FIXTURES, cg

# Half a bit of J1939's roll angle (SSI2), yaw rate and steering wheel.
HALF_A_BIT = {
    "roll_to_gravity_rad": np.radians(0.5 / 32768),
    "yaw_rate_radps": 0.5 / 8192,
    "steering_wheel_rad": 0.5 / 1024,
    "speed_mps": 0.5 / 256 / 3.6,
    "trailer_mass_kg": 1.0,
}
DBC = """VERSION ""
NS_ :
BS_:
BU_: Logger
BO_ 256 Motion: 8 Logger
 SG_ RollAngle : 0|16@1- (0.0005,0) [-16|16] "deg" Logger
 SG_ LatAccel : 16|16@1- (0.0005,0) [-16|16] "m/s^2" Logger
 SG_ WheelAngle : 32|16@1- (0.02,0) [-640|640] "°" Logger
BO_ 257 Slow: 8 Logger
 SG_ Speed : 0|16@1+ (0.01,0) [0|250] "km/h" Logger
 SG_ Mass : 16|16@1+ (2,0) [0|100000] "furlong" Logger
BO_ 258 Other: 8 Logger
 SG_ Speed : 0|8@1+ (1,0) [0|250] "km/h" Logger
"""
TRAILER_YAW = "[sensors.yaw_rate]\non_tractor = false\n"
SIGNALS = {
    "roll": "RollAngle",
    "lateral_acceleration": "LatAccel",
    "steering_wheel": "Motion.WheelAngle",
    "speed": "Slow.Speed",
    "trailer_mass": "Mass[kg]",
}


@pytest.fixture(scope="module")
def truck_file(tmp_path_factory):
    """Return the independent truck with a steering ratio, because CAN has the steering wheel only.

    Its roads are flat: on CAN, the roll angle is relative to gravity. The frames are made from logs
    with the yaw rate of the trailer.
    """
    path = tmp_path_factory.mktemp("truck") / "wheel.toml"
    text = (FIXTURES / "vehicles" / "kraz.toml").read_text()
    path.write_text(f"steering_ratio = 20.0\n{text}\n[road]\nbank_sd_rad = 0.0\n{TRAILER_YAW}")
    return path


@pytest.fixture(scope="module")
def truck(truck_file):
    """Return the same truck, loaded from its file."""
    return cgheight.Vehicle.load(truck_file)


@pytest.fixture(scope="module")
def drive(truck, tmp_path_factory):
    """Simulate a turn; return its columns and its candump log."""
    path = tmp_path_factory.mktemp("can") / "turn.log"
    scenario = Scenario("steady-turn", height_m=1.9, sensors=Sensors(snr_db=30))
    log = cgheight.simulate(truck, scenario, output=path)
    return log, path


def test_a_candump_log_is_the_simulated_one_to_half_a_bit(truck, drive):
    log, path = drive
    frame = read_log(path)
    assert len(frame) == len(log.signals["time_s"])
    assert np.max(np.abs(frame.time_s - log.signals["time_s"])) <= 5e-7
    expected = dict(log.signals)
    expected["roll_to_gravity_rad"] = expected.pop("roll_rad")
    expected["steering_wheel_rad"] = truck.steering_ratio * expected.pop("steer_rad")
    for name, half in HALF_A_BIT.items():
        seen = frame[name].dropna()
        assert len(seen) >= len(frame) - 1, name  # the first speed comes after the first roll
        error = np.max(np.abs(seen - expected[name][seen.index]))
        # Speed and mass are sent less often than they are sampled, but they are constant here.
        assert error <= half * (1 + 1e-9), name
    assert frame.attrs == {"remarks": []}


@pytest.mark.parametrize("suffix", [".log", ".blf"])
def test_a_frame_knows_how_exact_the_mass_on_the_bus_is(suffix, truck, drive, tmp_path):
    log, _ = drive
    path = tmp_path / f"turn{suffix}"
    cgheight.write_log(log, path, vehicle=truck)
    calibrated = cgheight.calibrate(truck.on_road("flat"), [(path, 1.9)], tmp_path / "c.toml")
    expected = cgheight.estimate_log(path, vehicle=calibrated)
    for frame in (cgheight.read_log(path), read_log(path)):
        answer = cgheight.estimate_log(frame, vehicle=calibrated)
        assert answer.height_sd_m == pytest.approx(expected.height_sd_m, rel=1e-6)
        exact = frame.drop(columns="trailer_mass_sd_kg")
        narrow = cgheight.estimate_log(exact, vehicle=calibrated)
        assert narrow.height_sd_m < 0.7 * expected.height_sd_m


def test_a_mass_of_zero_on_the_bus_is_not_exact(drive, tmp_path):
    _, path = drive
    lines = path.read_text().splitlines(keepends=True)
    weight = re.compile(r"(18FEEA..#F{6})(....)")
    zero = tmp_path / "zero.log"
    zero.write_text("".join(weight.sub(r"\g<1>0000", line) for line in lines))
    assert "trailer_mass_sd_kg" in read_log(path)
    frame = read_log(zero)
    assert frame.trailer_mass_kg.dropna().max() == 0.0
    assert "trailer_mass_sd_kg" not in frame


def test_a_calibration_from_frames_has_the_scale_of_the_vehicle_file(truck_file, drive, tmp_path):
    _, path = drive
    file = tmp_path / "truck.toml"
    file.write_text(f"{truck_file.read_text()}[sensors.mass]\nvehicle_weight_sd = 0.15\n")
    truck = cgheight.Vehicle.load(file).on_road("flat")
    cgheight.calibrate(truck, [(path, 1.9)], tmp_path / "c.toml")
    [run] = tomllib.loads((tmp_path / "c.toml").read_text())["run"]
    assert run["trailer_mass_sd_kg"] == pytest.approx(0.15 * run["trailer_mass_kg"], rel=1e-6)


@pytest.mark.parametrize("suffix", [".log", ".asc", ".blf", ".trc", ".mf4"])
def test_every_format_gives_the_height_of_the_arrays(suffix, truck, drive, tmp_path):
    log, _ = drive
    path = tmp_path / f"turn{suffix}"
    cgheight.write_log(log, path, vehicle=truck)
    # J1939 has no lateral acceleration of the trailer; yaw rate and speed stand in for it.
    signals = {k: v for k, v in log.signals.items() if k != "lateral_acceleration_mps2"}
    expected = cgheight.estimate(**signals, vehicle=truck)
    answer = cgheight.estimate_log(path, vehicle=truck)
    # Half a bit of the steering wheel is 0.5/1024/20 rad of 0.05 rad of steer angle, which is 5e-4
    # of the ratio; half a bit of the yaw rate is 0.5/8192 rad/s of 0.07 rad/s, 9e-4. The relative
    # change of the height is less than twice as large.
    assert answer.height_m == pytest.approx(expected.height_m, rel=2 * (5e-4 + 9e-4))
    assert answer.channel == expected.channel == "combined"
    again = cgheight.estimate_logs([path], vehicle=truck)[0]
    assert again == answer


@pytest.mark.parametrize(
    ("suffix", "names"),
    [
        (".log", ["can0", "can1"]),
        (".asc", ["1", "2"]),
        (".blf", [0, 1]),
        (".trc", ["1", "2"]),
        (".mf4", ["0", "1"]),
    ],
)
def test_one_of_two_buses_can_be_selected(suffix, names, truck, drive, tmp_path):
    log, first = drive
    second, both = tmp_path / "second.log", tmp_path / f"both{suffix}"
    other = dict(log.signals, roll_rad=0.5 * log.signals["roll_rad"])
    cgheight.write_log(other, second, vehicle=truck)
    with (
        can.LogReader(first) as one,
        can.LogReader(second) as two,
        can.Logger(both) as writer,
    ):
        for frames in zip(one, two, strict=True):
            for channel, frame in enumerate(frames):
                frame.channel = channel
                writer(frame)
    found = ", ".join(map(str, names))
    assert f"the buses {found}; each signal" in read_log(both).attrs["remarks"][0]
    for name, alone in zip(names, (first, second), strict=True):
        frame, expected = read_log(both, bus=name), read_log(alone)
        assert frame.attrs == {"remarks": []}
        # The angles are those of the frames; the rest is interpolated to times that formats round.
        assert np.array_equal(frame.roll_to_gravity_rad, expected.roll_to_gravity_rad)
    with pytest.raises(
        ValueError, match=f"no frame of the bus `7`; the buses in the log are {found}"
    ):
        read_log(both, bus=7)


def messages_by_dbc(log, folder):
    """Write a log with the frames of the DBC file; return the paths of both files."""
    dbc, path = folder / "truck.dbc", folder / "dbc.asc"
    dbc.write_text(DBC)
    s = log.signals
    with can.Logger(path) as writer:
        for k, time_s in enumerate(s["time_s"]):
            raw = [
                round(np.degrees(s["roll_rad"][k]) / 0.0005),
                round(s["lateral_acceleration_mps2"][k] / 0.0005),
                round(np.degrees(20 * s["steer_rad"][k]) / 0.02),
            ]
            data = b"".join(value.to_bytes(2, "little", signed=True) for value in raw) + bytes(2)
            frames = [(256, data)]
            if k % 10 == 0:
                values = round(s["speed_mps"][k] * 3.6 / 0.01), round(s["trailer_mass_kg"][k] / 2)
                data = b"".join(value.to_bytes(2, "little") for value in values) + bytes(4)
                frames = [(257, data), *frames, (0x7FF, b"\x01")]
            for identifier, content in frames:
                message = can.Message(
                    timestamp=time_s, arbitration_id=identifier, data=content, is_extended_id=False
                )
                writer.on_message_received(message)
    return path, dbc


def test_a_dbc_file_says_what_the_frames_hold(truck, drive, tmp_path):
    log, _ = drive
    path, dbc = messages_by_dbc(log, tmp_path)
    frame = read_log(path, dbc=dbc, signals=SIGNALS)
    # Half a bit of each signal at the scale of the DBC file.
    assert np.max(np.abs(frame.roll_rad - log.signals["roll_rad"])) <= np.radians(0.00025) * 1.01
    lateral = frame.lateral_acceleration_mps2 - log.signals["lateral_acceleration_mps2"]
    assert np.max(np.abs(lateral)) <= 0.00025 * 1.01
    assert frame.speed_mps.dropna().iloc[0] == pytest.approx(50.0 / 3.6, abs=0.005 / 3.6 * 1.01)
    assert "trailer_mass_kg" in frame
    expected = cgheight.estimate(**log.signals, vehicle=truck).height_m
    answer = cgheight.estimate_log(frame, vehicle=truck)
    assert answer.height_m == pytest.approx(expected, rel=1e-3)
    flipped = read_log(path, dbc=dbc, signals=SIGNALS, flip="roll")
    assert np.array_equal(flipped.roll_rad, -frame.roll_rad)


def test_measured_channels_of_an_mdf_file(truck, drive, tmp_path):
    log, _ = drive
    s = log.signals
    mdf = asammdf.MDF()
    fast, slow = s["time_s"], s["time_s"][::10]
    assert len(slow) < len(fast)
    roll = asammdf.Signal(np.degrees(s["roll_rad"]), fast, name="Roll", unit="deg")
    lateral = asammdf.Signal(s["lateral_acceleration_mps2"], fast, name="Ay", unit="m/s^2")
    mdf.append([roll, lateral])
    mdf.append([asammdf.Signal(s["speed_mps"][::10] * 3.6, slow, name="V", unit="km/h")])
    path = mdf.save(tmp_path / "measured.mf4")
    frame = read_log(path, signals={"roll": "Roll", "lateral_acceleration": "Ay", "speed": "V"})
    assert frame.roll_rad.to_numpy() == pytest.approx(s["roll_rad"], abs=1e-15)
    assert frame.speed_mps.to_numpy() == pytest.approx(s["speed_mps"], rel=1e-12)
    answer = cgheight.estimate_log(frame, vehicle=truck, trailer_mass_kg=s["trailer_mass_kg"][0])
    assert answer.channel == "lateral-acceleration"
    assert answer.status == "ok"
    flipped = read_log(path, signals={"roll": "Roll", "speed": "V"}, flip="roll")
    assert np.array_equal(flipped.roll_rad, -frame.roll_rad)
    with pytest.raises(ValueError, match=r"Roll has the unit \"furlong\": give one of rad, deg"):
        read_log(path, signals={"roll": "Roll[furlong]"})
    with pytest.raises(ValueError, match=r"has no channel Rol; it has .*Roll"):
        read_log(path, signals={"roll": "Rol"})
    with pytest.raises(ValueError, match="contains no roll angle"):
        read_log(path, signals={"speed": "V"})


# python-can does not close a file with a damaged header.
@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_what_is_wrong_with_a_log_or_its_names_is_said(truck, drive, tmp_path):
    log, path = drive
    with pytest.raises(FileNotFoundError, match=r"nowhere\.blf: cannot be read"):
        read_log(tmp_path / "nowhere.blf")
    with pytest.raises(ValueError, match=r"is not a CAN log by its name; .* ends in \.log, \.asc"):
        read_log(tmp_path / "a.csv")
    (tmp_path / "bad.blf").write_bytes(b"no frames here" * 20)
    with pytest.raises(ValueError, match=r"bad\.blf, after 0 frames: cannot be read in the format"):
        read_log(tmp_path / "bad.blf")
    cgheight.write_log(log, tmp_path / "cut.blf", vehicle=truck)
    whole = (tmp_path / "cut.blf").read_bytes()
    (tmp_path / "cut.blf").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=rf"cut off: it has {len(whole) // 2} of {len(whole)} b"):
        read_log(tmp_path / "cut.blf")
    (tmp_path / "no.log").write_text("(0.000000) can0 18FEF100#FF00FFFFFFFFFFFF\n")
    with pytest.raises(ValueError, match="none of its 1 frames contains a valid roll angle"):
        read_log(tmp_path / "no.log")
    dbc_log, dbc = messages_by_dbc(log, tmp_path)
    with pytest.raises(ValueError, match="signals contains names from a DBC file"):
        read_log(dbc_log, signals=SIGNALS)
    with pytest.raises(ValueError, match=r"truck\.dbc: give the names of the signals in it"):
        read_log(dbc_log, dbc=dbc)
    with pytest.raises(ValueError, match=r"has no signal `Rolll`, only Motion\.RollAngle"):
        read_log(dbc_log, dbc=dbc, signals=SIGNALS | {"roll": "Rolll"})
    with pytest.raises(ValueError, match=r"Speed is in several messages: give one of Slow\.Speed"):
        read_log(dbc_log, dbc=dbc, signals=SIGNALS | {"speed": "Speed"})
    unit = r'unit "furlong" is not one of kg, .*give the unit: trailer_mass=Slow\.Mass\[kg\]'
    with pytest.raises(ValueError, match=unit):
        read_log(dbc_log, dbc=dbc, signals=SIGNALS | {"trailer_mass": "Mass"})
    (tmp_path / "bad.dbc").write_text("BO_ 1")
    with pytest.raises(ValueError, match=r"bad\.dbc: not a DBC file"):
        read_log(dbc_log, dbc=tmp_path / "bad.dbc", signals=SIGNALS)
    with pytest.raises(FileNotFoundError):
        read_log(dbc_log, dbc=tmp_path / "nowhere.dbc", signals=SIGNALS)
    with pytest.raises(ValueError, match="signals: there is no quantity `rol`"):
        read_log(dbc_log, dbc=dbc, signals={"rol": "RollAngle"})
    with pytest.raises(ValueError, match="columns applies to tables only"):
        cgheight.read_log(path, columns={"roll": "x[deg]"})


# A roll angle of 6 degrees from a sensor without information on its compensation.
UNSAID = "(0.100000) can0 0CF029E4#FFFFFF000080FFFF\n"
VDC2 = "(0.000000) can0 18F0090B#7F7DFF007D007DFF\n"


def test_what_a_slope_sensor_measures_can_be_told(tmp_path):
    path = tmp_path / "slope.log"
    path.write_text(VDC2 + UNSAID)
    for word, column in [("bit", "tilt_rad"), ("yes", "roll_to_gravity_rad"), ("no", "tilt_rad")]:
        frame = read_log(path, roll_compensated=word, flip="roll")
        assert frame[column][0] < 0  # the sign is reversed for both
        assert len({"roll_to_gravity_rad", "tilt_rad"} & set(frame)) == 1
        doubts = frame.attrs["remarks"]
        assert ['roll_compensated="yes"' in doubt for doubt in doubts] == [True] * (word == "bit")
    with pytest.raises(ValueError, match='roll_compensated is "on": it must be "bit", "inverted'):
        read_log(path, roll_compensated="on")


@pytest.fixture(scope="module")
def asynchronous(truck, tmp_path_factory):
    """Return a candump log of two turns whose signals have different rates and times."""
    folder = tmp_path_factory.mktemp("asynchronous")
    sensors = Sensors(snr_db=25)
    drive = Scenario("drive", height_m=1.8, duration_s=120, rate_hz=200, sensors=sensors, seed=7)
    cgheight.simulate(truck, drive, output=folder / "fast.log")
    random = np.random.default_rng(5)
    # Identifier: the share of its frames that is kept, and their delay.
    kept = {"18F0090B": (0.2, 3e-3), "0CF029E4": (0.11, 11e-3), "18FEF100": (0.5, 40e-3)}
    lines = []
    for line in (folder / "fast.log").read_text().splitlines():
        stamp, bus, frame = line.split()
        share, late_s = kept.get(frame[:8], (1.0, 0.0))
        if random.random() < share:
            time_s = float(stamp[1:-1]) + random.uniform(0.0, late_s)
            lines.append((time_s, f"({1.7e9 + time_s:.6f}) {bus} {frame}"))
    path = folder / "asynchronous.log"
    path.write_text("".join(f"{line}\n" for _, line in sorted(lines)))
    return path


def maneuvers_of_cg_run(vehicle, log, *options):
    """Return the maneuver lines of `cg run --candump`."""
    told = subprocess.run(
        [cg(), "run", "--vehicle", vehicle, "--candump", log, *options],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    lines = [json.loads(line) for line in told.stdout.splitlines()]
    return [line for line in lines if line["event"] == "maneuver"]


def test_python_and_cg_run_hear_the_same(truck_file, asynchronous):
    truck = cgheight.Vehicle.load(truck_file)
    told = maneuvers_of_cg_run(truck_file, asynchronous)
    assert len(told) >= 4
    for channel in ("steer", "lateral-acceleration"):
        listener = HeightListener(truck, channel=channel)
        with can.LogReader(asynchronous) as frames:
            for message in frames:
                listener(message)
        heard = listener.estimate().maneuvers
        assert len(heard) == len(told)
        for maneuver, line in zip(heard, told, strict=True):
            known = line[channel.replace("-", "_")]
            for name in ("start_s", "end_s", "height_m", "height_sd_m", "ratio", "ratio_sd"):
                # The same frames and the same arithmetic; only the origin of time differs.
                expected = pytest.approx(known[name], rel=1e-12, abs=0)
                assert getattr(maneuver, name) == expected, (channel, name)


def test_the_last_height_is_that_of_cg_run(truck_file, asynchronous):
    told = maneuvers_of_cg_run(truck_file, asynchronous)[-1]
    answer = cgheight.estimate_log(asynchronous, vehicle=cgheight.Vehicle.load(truck_file))
    for name in ("height_m", "height_sd_m"):
        assert getattr(answer, name) == pytest.approx(told[name], rel=1e-12), name


@pytest.mark.parametrize("suffix", [".asc", ".blf", ".trc", ".mf4"])
def test_frames_of_every_format_make_the_rows_of_the_candump_log(suffix, asynchronous, tmp_path):
    path = tmp_path / f"copy{suffix}"
    with can.LogReader(asynchronous) as frames, can.Logger(path) as writer:
        for message in frames:
            message.timestamp -= 1.7e9
            message.is_rx = True
            writer.on_message_received(message)
    expected, frame = read_log(asynchronous), read_log(path)
    assert list(frame) == list(expected)
    # The formats store time with a resolution of 10 µs (.asc) or better, from different origins.
    # Interpolated signals change by that time times their largest rate, a few units a second.
    assert len(frame) == len(expected)
    for name in set(frame) - {"time_s"}:
        assert np.allclose(frame[name], expected[name], rtol=0, atol=2e-3, equal_nan=True), name


def test_the_listener_on_a_virtual_bus_gives_the_height_of_the_log(truck, drive):
    _, path = drive
    heard = []
    listener = HeightListener(truck, on_estimate=heard.append)
    options = {"interface": "virtual", "preserve_timestamps": True}
    with can.Bus("height", **options) as here, can.Bus("height", **options) as there:
        with can.Notifier(here, [listener]), can.LogReader(path) as frames:
            sent = 0
            for message in frames:
                there.send(message)
                sent += 1
            deadline = time.monotonic() + 30
            while listener.frames < sent and time.monotonic() < deadline:
                time.sleep(0.01)
        assert (listener.frames, listener.frames_used) == (sent, sent)
    assert listener.rows >= len(read_log(path)) - 1  # the last one waits for later frames
    assert listener.estimate() == cgheight.estimate_log(path, vehicle=truck)
    assert len(heard) == 1  # one turn
    assert heard[0].status == "ok"


def test_the_listener_leaves_out_what_does_not_fit_and_goes_on(truck, drive):
    _, path = drive
    listener = HeightListener(truck)
    with can.LogReader(path) as frames:
        for message in frames:
            listener(message)
            if message.arbitration_id == 0x0CF029E4:
                listener(message)  # twice the same time
    listener(can.Message(is_error_frame=True, timestamp=0.0))
    assert listener.rows >= len(read_log(path)) - 1
    assert listener.estimate() == cgheight.estimate_log(path, vehicle=truck)
    with pytest.raises(ValueError, match="order is 50"):
        HeightListener(truck, method=cgheight.Arx(50))


@pytest.fixture(autouse=True)
def quiet_libraries():
    """Hide the messages of asammdf about conversions in the test output."""
    logging.getLogger("asammdf").setLevel(logging.ERROR)


def test_a_simulated_bus_has_the_yaw_rate_of_the_tractor(truck_file, tmp_path):
    """Unless the vehicle file says that it is that of the trailer."""
    silent = tmp_path / "silent.toml"
    silent.write_text(truck_file.read_text().replace(TRAILER_YAW, ""))
    truck = cgheight.Vehicle.load(silent)
    change = cgheight.Scenario(
        "lane-change", plant="nonlinear", height_m=1.9, payload_kg=14e3, rate_hz=50
    )
    path = tmp_path / "change.blf"
    log = cgheight.simulate(truck, change, output=path)
    on_bus = read_log(path)
    both = np.column_stack([on_bus.yaw_rate_radps, log.signals["yaw_rate_radps"][: len(on_bus)]])
    first, second = (np.nanargmax(column) for column in both.T)
    assert 0.2 < (second - first) / 50 < 0.8  # the trailer follows
    answer = cgheight.estimate_log(path, vehicle=truck)
    assert answer.height_m == pytest.approx(1.9, rel=0.02)
    # The table says it, too.
    of_table = cgheight.estimate_log(on_bus, vehicle=truck)
    assert of_table.height_m == pytest.approx(answer.height_m, rel=1e-4)
    by_yaw = on_bus.drop(columns="steering_wheel_rad")
    assert cgheight.estimate_log(by_yaw, vehicle=truck).height_m == pytest.approx(1.9, rel=0.02)
    unsaid = by_yaw.drop(columns="yaw_rate_on_tractor")
    assert cgheight.estimate_log(unsaid, vehicle=truck).height_m is None
