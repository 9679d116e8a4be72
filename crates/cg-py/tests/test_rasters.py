"""Channels with time stamps of their own, in tables and as measured channels of MF4 files."""

from __future__ import annotations

import asammdf
import numpy as np
import pandas as pd
import pytest

import cgheight
from conftest import FIXTURES, ONE_TURN, read

UNITS = {
    "roll_rad": "rad",
    "steer_rad": "rad",
    "speed_mps": "m/s",
    "yaw_rate_radps": "rad/s",
    "lateral_acceleration_mps2": "m/s^2",
    "trailer_mass_kg": "kg",
}
INPUTS = ["lateral_acceleration_mps2", "yaw_rate_radps"]


@pytest.fixture(scope="module")
def height(kraz) -> float:
    answer = cgheight.estimate_log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz)
    return answer.height_m


def channels(turn, names, *, every=1, **changed):
    """Return channels with a raster of their own; `changed` replaces values, units and times."""
    units = UNITS | changed.get("units", {})
    values = {name: turn[name] for name in names} | changed.get("values", {})
    time_s = changed.get("time_s", turn["time_s"])
    return [
        asammdf.Signal(values[name][::every], time_s[::every], name=name, unit=units[name])
        for name in names
    ]


def saved(path, *groups):
    mdf = asammdf.MDF()
    for group in groups:
        mdf.append(group, common_timebase=True)
    return mdf.save(path, overwrite=True)


def late(turn, names, by_s=0.004):
    """Return channels in every other row, as a table of their own."""
    table = pd.DataFrame({name: turn[name][::2] for name in names})
    table.insert(0, "time_s", turn["time_s"][::2] + by_s)
    return table


@pytest.mark.parametrize("kind", ["csv", "frame", "mf4"])
def test_inputs_in_rows_of_their_own_are_used_beside_one_with_the_roll_angle(
    kind, kraz, turn, height, tmp_path
):
    """A third of the rows; the steer angle alone is 10 % off, with an interval twice as wide."""
    rest = [name for name in UNITS if name not in INPUTS]
    both = pd.concat([pd.DataFrame({"time_s": turn["time_s"]} | {n: turn[n] for n in rest})])
    both = pd.concat([both, late(turn, INPUTS)]).sort_values("time_s").reset_index(drop=True)
    log = both
    if kind == "csv":
        log = tmp_path / "log.csv"
        both.to_csv(log, index=False)
    elif kind == "mf4":
        later = channels(turn, INPUTS, every=2, time_s=turn["time_s"] + 0.004)
        log = saved(tmp_path / "log.mf4", channels(turn, rest), later)
    answer = cgheight.estimate_log(log, vehicle=kraz)
    assert answer.channel == "combined"
    # Linear interpolation over 20 ms, 4 ms late, of a turn that builds up in a second.
    assert answer.height_m == pytest.approx(height, rel=5e-3)


@pytest.mark.parametrize("time_s", [-0.004, 0.004, 1.004])
def test_a_mass_in_a_row_of_its_own_counts(time_s, kraz):
    """The mass of the vehicle file is another one."""
    turn = read("A_p20_h190_v50_L.csv")
    frame = pd.DataFrame({name: turn[name] for name in ["time_s", *UNITS]})
    height = cgheight.estimate_log(frame, vehicle=kraz).height_m
    mass = pd.DataFrame({"time_s": [time_s], "trailer_mass_kg": [turn["trailer_mass_kg"][0]]})
    frame = pd.concat([frame.drop(columns="trailer_mass_kg"), mass]).sort_values("time_s")
    answer = cgheight.estimate_log(frame, vehicle=kraz)
    # Rows before the mass came have none.
    assert answer.height_m == pytest.approx(height, rel=1e-3)
    assert not any("mass" in message for message in answer.messages)


@pytest.mark.parametrize("apart", [False, True])
def test_a_table_without_a_speed_keeps_steer_angle_and_yaw_rate(apart, kraz, turn, tmp_path):
    """The speed is given elsewhere."""
    slow = ["yaw_rate_radps", "steer_rad"]
    groups = [channels(turn, ["roll_rad"]), channels(turn, slow, every=3)]
    path = saved(
        tmp_path / "log.mf4", *(groups if apart else [channels(turn, ["roll_rad", *slow])])
    )
    answer = cgheight.estimate_log(path, vehicle=kraz, trailer_mass_kg=28684.0, speed_mps=13.889)
    assert answer.status == "ok"
    assert {channel.channel for channel in answer.channels} == {"steer", "lateral-acceleration"}


def test_what_is_wrong_with_measured_channels_is_said(kraz, turn, tmp_path):
    path = tmp_path / "log.mf4"
    fast = ["roll_rad", "steer_rad", "speed_mps", "trailer_mass_kg"]

    def refused(match, *groups):
        with pytest.raises(ValueError, match=rf"log\.mf4: .*{match}"):
            cgheight.estimate_log(saved(path, *groups), vehicle=kraz)

    slow = channels(turn, INPUTS, every=2, units={"yaw_rate_radps": "1/s"})
    for signal in slow:
        signal.name = signal.name.replace("yaw_rate_radps", "YawRate")
    refused(r"YawRate \[1/s\].*unknown unit", channels(turn, fast), slow)
    back_s = turn["time_s"].copy()
    back_s[800:] -= 4.0
    refused(
        r"time stamp 4 s of value 800 does not come after 7\.99 s",
        channels(turn, fast, time_s=back_s),
        channels(turn, INPUTS, every=2),
    )
    mdf = asammdf.MDF()
    mdf.append(channels(turn, fast, time_s=14.0 * turn["time_s"]), common_timebase=True)
    master = mdf.groups[0].channels[0]
    master.name, master.unit, master.sync_type = "distance", "m", 3
    mdf.save(path, overwrite=True)
    with pytest.raises(ValueError, match=r"recorded over distance, which is not a time"):
        cgheight.estimate_log(path, vehicle=kraz)


def test_impossible_values_of_measured_channels_are_told(kraz, turn, tmp_path):
    roll_rad = turn["roll_rad"].copy()
    roll_rad[::3] = 2.0
    first = channels(turn, ["roll_rad"], values={"roll_rad": roll_rad})
    rest = channels(turn, [name for name in UNITS if name != "roll_rad"], every=2)
    path = saved(tmp_path / "log.mf4", first, rest)
    answer = cgheight.estimate_log(path, vehicle=kraz)
    assert any("roll_rad 2 is impossible" in message for message in answer.messages)
    frame = cgheight.can.read_log(path, signals={"roll": "roll_rad", "steer": "steer_rad"})
    assert any("time stamps of their own" in remark for remark in frame.attrs["remarks"])


@pytest.mark.parametrize("suffix", [".log", ".blf", ".csv"])
def test_a_log_that_begins_before_its_time_zero_is_written_whole(suffix, kraz, turn, tmp_path):
    truck = kraz.with_({"steering_ratio": 20.0})
    early = {"time_s": turn["time_s"] - 5.0} | {name: turn[name] for name in UNITS}
    path = tmp_path / f"early{suffix}"
    cgheight.write_log(early, path, vehicle=truck)
    back = cgheight.read_log(path)
    assert len(back) == len(turn["time_s"])
    assert np.diff(back.time_s) == pytest.approx(np.diff(turn["time_s"]), abs=2e-6)


def test_columns_that_frames_lack_are_told(kraz, turn, tmp_path):
    table = {"time_s": turn["time_s"], "speed_mps": turn["speed_mps"], "roll_rad": turn["roll_rad"]}
    table |= {"lateral_specific_force_mps2": turn["lateral_acceleration_mps2"]}
    with pytest.warns(UserWarning, match=r"contains no lateral_specific_force_mps2: J1939"):
        cgheight.write_log(table, tmp_path / "log.log", vehicle=kraz)
