"""The linear model: comparison with the printed tables, and consistency."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import cgheight
from conftest import FIXTURES

# Table 4.2, upper half plane. Four decimals are printed: half a unit in both parts is 0.7e-4.
POLES = [-7.6665 + 60.6146j, -5.0701 + 51.9695j, -10.1493, -1.3959 + 5.5499j, -1.2621 + 1.2798j]
# Table 4.1: A0 and B0, five digits.
PRINTED_RATIO = 4.5839e25 / 8.0754e25


@pytest.fixture(scope="module")
def printed(baseline) -> cgheight.LinearModel:
    return cgheight.linear_model(baseline, model="as-printed")


def test_the_poles_are_those_of_the_table(printed):
    assert printed.poles.dtype == np.complex128
    for pole in POLES:
        assert np.min(np.abs(printed.poles - pole)) <= 1e-4


def test_the_dc_ratio_is_that_of_the_table(printed):
    # Twice half a unit of the fifth digit.
    assert printed.dc_gain == pytest.approx(PRINTED_RATIO, rel=2e-5)
    assert printed.dc_gain == pytest.approx(printed.ratio.ratio_at(printed.height_m), rel=1e-9)
    # Two solutions of an 18 × 18 system with a condition number near 1e5.
    reduced = printed.reduced
    assert reduced.numerator[-1] / reduced.denominator[-1] == pytest.approx(
        printed.dc_gain, rel=1e-9
    )


def test_polynomials_roots_and_state_space_are_one_transfer_function(printed):
    s = 2.0j
    value = np.polyval(printed.numerator, s) / np.polyval(printed.denominator, s)
    factored = printed.gain * np.prod(s - printed.zeros) / np.prod(s - printed.poles)
    n = len(printed.poles)
    assert printed.A.shape == (n, n) == (18, 18)
    assert (printed.B.shape, printed.C.shape, printed.D.shape) == ((n, 1), (1, n), (1, 1))
    states = np.linalg.solve(s * np.eye(n) - printed.A, printed.B)
    expected = (printed.C @ states + printed.D)[0, 0]
    # Polynomials of degree 18 with coefficients up to 1e26: 1e-6 is ε times their cancellation
    # at |s| = 2, below 1e9.
    assert value == pytest.approx(expected, rel=1e-6)
    assert factored == pytest.approx(expected, rel=1e-6)
    assert printed.denominator[0] == 1.0
    assert printed.numerator[0] == pytest.approx(printed.gain)


def test_loads_are_in_balance(baseline):
    model = cgheight.linear_model(baseline)
    balance = model.static_balance
    # The share of the tractor is the same for every load: the weights differ by the added mass.
    heavier = cgheight.linear_model(baseline, trailer_mass_kg=model.trailer_mass_kg + 1000)
    added = np.sum(heavier.static_balance.axle_load_n) - np.sum(balance.axle_load_n)
    file = tomllib.loads((FIXTURES / "vehicles" / "baseline.toml").read_text())
    # Rounding: ε times total weight / added weight = 1e-14, with a wide margin.
    assert added == pytest.approx(1000 * file["gravity_mps2"], rel=1e-9)
    assert abs(balance.residual_nm) < 1e-6 * balance.hitch_load_n
    assert 0 < balance.hitch_load_n < np.sum(balance.axle_load_n)


def test_speed_and_height_act(baseline):
    model = cgheight.linear_model(baseline)
    higher = cgheight.linear_model(baseline, height_m=model.height_m + 0.3)
    faster = cgheight.linear_model(baseline, speed_mps=model.speed_mps + 3)
    assert higher.dc_gain > model.dc_gain
    assert faster.dc_gain > model.dc_gain
    assert higher.height_m == model.height_m + 0.3
    # Exactly a quotient of two linear functions of the height; rounding as above.
    assert higher.dc_gain == pytest.approx(model.ratio.ratio_at(higher.height_m), rel=1e-8)
    assert model.reduced.order == 5
    assert len(model.reduced.numerator) == len(model.reduced.denominator) == 6
    assert repr(model).startswith("LinearModel('baseline', 13.89 m/s, trailer ")


@pytest.mark.parametrize("options", [
    {"model": "printed"},
    {"speed_mps": 0.0},
    {"height_m": float("nan")},
    {"trailer_mass_kg": -1.0},
    {"trailer_mass_kg": 100.0},
    {"model": "as-printed", "trailer_mass_kg": 20000.0},
])  # fmt: skip
def test_what_cannot_be_is_refused(baseline, options):
    word = 'model="complete"' if len(options) == 2 else next(iter(options)).replace("_kg", "")
    with pytest.raises(ValueError, match=word.replace("trailer_mass", "trailer.mass")):
        cgheight.linear_model(baseline, **options)


def test_an_unstable_vehicle_is_refused_with_its_pole(baseline):
    with pytest.raises(ValueError, match=r"unstable at this speed and load \(pole"):
        cgheight.linear_model(baseline, height_m=6.0, trailer_mass_kg=80e3)
