"""The J1939 table of the core and the transmitted frame, compared with cantools and a DBC file."""

import math
from pathlib import Path

import cantools
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cgheight import _native
from cgheight._frames import reading

FIXTURES = Path(__file__).parents[3] / "fixtures" / "can"
J1939 = cantools.database.load_file(FIXTURES / "j1939.dbc")
TO_SI = {"rad": 1.0, "rad/s": 1.0, "m/s2": 1.0, "kg": 1.0, "deg": math.pi / 180, "km/h": 1 / 3.6}
TO_SI |= {"mm": 1e-3, "kPa": 1e3}
# Message, signal, column of a log.
SIGNALS = [
    ("VDC2", "SteeringWheelAngle", "steering_wheel_rad"),
    ("VDC2", "YawRate", "yaw_rate_radps"),
    ("VDC2", "LateralAcceleration", "tractor_lateral_specific_force_mps2"),
    ("SAS", "SteeringWheelAngle", "steering_wheel_rad"),
    ("SSI2", "RollAngle", "roll_to_gravity_rad"),
    ("SSI", "RollAngle", "tilt_rad"),
    ("CCVS1", "WheelBasedVehicleSpeed", "speed_mps"),
    ("EBC2", "FrontAxleSpeed", "speed_mps"),
    ("VW", "TrailerWeight", "trailer_mass_kg"),
    ("EBS22", "AxleLoadSum", "trailer_axle_load_kg"),
    ("ASC3", "RearLeftLevel", "tractor_level_left_m"),
    ("ASC3", "RearRightLevel", "tractor_level_right_m"),
    ("ASC4", "RearLeftPressure", "drive_pressure_left_pa"),
    ("ASC4", "RearRightPressure", "drive_pressure_right_pa"),
]
# The largest plausible values of these signals; larger values are treated as absent.
GREATEST = {"roll_to_gravity_rad": 1.0, "speed_mps": 60.0, "drive_pressure_left_pa": 2e6}
GREATEST["drive_pressure_right_pa"] = 2e6
SSI, SSI2, CCVS1 = 0x0CF013E4, 0x0CF029E4, 0x18FEF100


def row_of(identifier: int, data: bytes, column: str, word: str = "bit") -> dict[str, float]:
    """Return the row of a frame, with the angle and the speed that every row needs."""
    table = _native.FrameTable(reading(roll_compensated=word))
    if column != "speed_mps":
        table.push((0.0, 0), CCVS1, True, bytes.fromhex("FF0032FFFFFFFFFF"))
    table.push((0.0, 0), identifier, True, data)
    if column not in ("roll_to_gravity_rad", "tilt_rad"):
        table.push((0.0, 0), SSI2, True, bytes.fromhex("FFFFFF00007DCFFF"))
    return {name: values[0] for name, values in table.finish().items()}


@pytest.mark.parametrize(("message", "signal", "column"), SIGNALS)
@given(share=st.floats(0, 1), source=st.integers(0, 253), priority=st.integers(0, 7))
def test_every_signal_comes_back_as_cantools_wrote_it(
    message: str, signal: str, column: str, share: float, source: int, priority: int
) -> None:
    definition = J1939.get_message_by_name(message)
    field = definition.get_signal_by_name(signal)
    size = field.length
    # Valid values that the quantity can have.
    possible = GREATEST.get(column, np.inf) / TO_SI[field.unit]
    ends = [(end - field.offset) / field.scale for end in (-possible, possible)]
    least, greatest = max(0, np.ceil(ends[0])), min((0xFB << (size - 8)) - 1, np.floor(ends[1]))
    raw = int(least + round(share * (greatest - least)))
    everything = {other.name: (1 << other.length) - 1 for other in definition.signals}
    data = definition.encode({**everything, signal: raw}, scaling=False, strict=False)
    identifier = (definition.frame_id & 0x03FFFF00) | priority << 26 | source
    # The other bits have no effect: an option decides whether the angle is roll or tilt.
    word = "no" if column == "tilt_rad" else "yes"
    expected = definition.decode(data, decode_choices=False)[signal] * TO_SI[field.unit]
    value = row_of(identifier, bytes(data), column, word)[column]
    # Both sides multiply and add once in double precision.
    assert value == pytest.approx(expected, rel=1e-12, abs=1e-12 * abs(field.offset or 1))


@pytest.mark.parametrize(("message", "signal", "column"), SIGNALS)
@given(share=st.floats(0, 1))
def test_what_is_not_available_is_absent(
    message: str, signal: str, column: str, share: float
) -> None:
    definition = J1939.get_message_by_name(message)
    size = definition.get_signal_by_name(signal).length
    least = 0xFB << (size - 8)
    raw = least + round(share * ((1 << size) - 1 - least))
    everything = {other.name: (1 << other.length) - 1 for other in definition.signals}
    data = definition.encode({**everything, signal: raw}, scaling=False, strict=False)
    assert column not in row_of(definition.frame_id & 0x1FFFFFFF, bytes(data), column)


@pytest.mark.parametrize(("identifier", "at", "merit_at"), [(SSI, 6, 2), (SSI2, 4, 6)])
@pytest.mark.parametrize(
    ("bits", "expected"),
    [
        (0, ["roll_to_gravity_rad", "tilt_rad", "roll_to_gravity_rad", "tilt_rad"]),
        (1, ["tilt_rad", "roll_to_gravity_rad", "roll_to_gravity_rad", "tilt_rad"]),
        (2, [None, None, "roll_to_gravity_rad", "tilt_rad"]),
        (3, ["tilt_rad", "tilt_rad", "roll_to_gravity_rad", "tilt_rad"]),
    ],
)
def test_the_compensation_bits_tell_roll_from_tilt(
    identifier: int, at: int, merit_at: int, bits: int, expected: list[str | None]
) -> None:
    data = bytearray.fromhex("0000007D007DFFFF")  # close to zero degrees in both
    data[6] = 0xFF & ~(3 << at) | bits << at
    for word, column in zip(["bit", "inverted-bit", "yes", "no"], expected, strict=True):
        found = row_of(identifier, bytes(data), "roll_to_gravity_rad", word)
        assert {"roll_to_gravity_rad", "tilt_rad"} & found.keys() == ({column} - {None})
    data[6] = data[6] & ~(3 << merit_at) | 2 << merit_at  # the figure of merit: error
    assert row_of(identifier, bytes(data), "roll_to_gravity_rad", "yes") == {}
    with pytest.raises(ValueError, match='roll_compensated is "maybe": it must be "bit"'):
        row_of(identifier, bytes(data), "roll_to_gravity_rad", "maybe")


def test_cantools_reads_the_frame_that_is_sent() -> None:
    ours = cantools.database.load_file(FIXTURES / "cg_height.dbc")
    frame = ours.get_message_by_name("CG_HEIGHT_STATUS")
    assert frame.frame_id >> 8 & 0x3FFFF == 65296
    # The bytes of a test in crates/cg-cli/src/run/transmit.rs.
    told = frame.decode(bytes([0x6C, 0x07, 250, 250, 0, 0, 1, 250]))
    assert told["Height"] == pytest.approx(1.9)
    assert told["HeightSd"] == pytest.approx(1.25)
    assert told["RolloverThreshold"] == pytest.approx(1.25)
    assert told["RolloverMargin"] == pytest.approx(-1.25)
    assert (told["WarningLevel"], told["Maneuvers"]) == (0, 250)
    assert str(told["Status"]) == "Height known"
    request = ours.get_message_by_name("CG_SPEED_REQUEST")
    assert request.frame_id >> 8 & 0x3FFFF == 65297
    asked = request.decode(bytes([0x00, 54, *[0xFF] * 6]))
    assert asked["RequestedSpeed"] == pytest.approx(54.0)  # km/h
