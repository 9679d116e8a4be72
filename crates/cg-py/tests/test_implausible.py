"""Values that a truck cannot have are absent, with the same messages for every form of a log."""

from __future__ import annotations

import copy

import numpy as np
import pandas as pd
import pytest

import cgheight


def doubts(answer: cgheight.Estimate) -> list[str]:
    return [message for message in answer.messages if "is impossible" in message]


@pytest.fixture(scope="module")
def faulty(turn) -> dict[str, np.ndarray]:
    """Return a log with two speeds of no truck and one roll angle of no trailer."""
    table = {name: values.copy() for name, values in turn.items()}
    table["speed_mps"][[16, 40]] = 79.97, -30.0
    table["roll_rad"][100] = 7.0
    return table


def test_every_form_of_a_log_has_the_messages_of_a_file(kraz, faulty, tmp_path):
    path = tmp_path / "log.parquet"
    pd.DataFrame(faulty).to_parquet(path)
    expected = cgheight.estimate_log(path, vehicle=kraz)
    assert doubts(expected) == [
        "roll: row 101: roll_rad 7 is impossible (possible: -1 to 1); such values count as absent; "
        "check the sensor and the unit (1 in all)",
        "speed: row 17: speed_mps 79.97 is impossible (possible: -20 to 60); such values count as "
        "absent; check the sensor and the unit (2 in all)",
    ]
    assert expected.status == "ok"
    assert cgheight.estimate_log(pd.DataFrame(faulty), vehicle=kraz) == expected
    assert cgheight.estimate_log(faulty, vehicle=kraz) == expected
    assert cgheight.estimate(**faulty, vehicle=kraz) == expected
    batch = cgheight.estimate_logs({"one": faulty}, vehicle=kraz)
    assert batch[0] == expected


def test_a_mass_that_the_vehicle_cannot_have_is_told(kraz, turn, tmp_path):
    table = {**turn, "trailer_mass_kg": np.full(len(turn["time_s"]), 300.0)}
    path = tmp_path / "log.parquet"
    pd.DataFrame(table).to_parquet(path)
    expected = cgheight.estimate_log(path, vehicle=kraz)
    assert "trailer_mass_kg 300 is impossible (the vehicle file allows" in doubts(expected)[0]
    assert cgheight.estimate(**table, vehicle=kraz) == expected


def test_the_estimator_row_by_row_has_them_too_and_keeps_them(kraz, faulty):
    estimator = cgheight.Estimator(kraz)
    names = list(faulty)
    for place, row in enumerate(zip(*faulty.values(), strict=True)):
        estimator.push(**dict(zip(names, row, strict=True)))
        if place == 50:
            estimator = copy.copy(estimator)
    assert estimator.estimate() == cgheight.estimate(**faulty, vehicle=kraz)
    assert len(doubts(estimator.estimate())) == 2


def test_rows_that_are_prepared_first_have_them_too(kraz, faulty, turn, tmp_path):
    table = {name: values for name, values in faulty.items() if name != "roll_rad"}
    table["roll_rate_radps"] = np.gradient(turn["roll_rad"], turn["time_s"])
    path = tmp_path / "log.parquet"
    pd.DataFrame(table).to_parquet(path)
    expected = cgheight.estimate_log(path, vehicle=kraz)
    assert len(doubts(expected)) == 1
    assert cgheight.estimate_log(table, vehicle=kraz) == expected
