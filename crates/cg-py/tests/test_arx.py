"""ARX least squares against independent solutions."""

from __future__ import annotations

import csv
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cgheight
from conftest import FIXTURES, ONE_TURN, read

EPSILON = np.finfo(float).eps
CASES = tomllib.loads((FIXTURES / "arx" / "case.toml").read_text())
# Eq. 5.12 in descending powers, with the signs of this project.
NUMERATOR = [-0.2554, 2.6063, -0.9015, 24.3105, 27.8430, 51.7785]
DENOMINATOR = [1.0, 5.8858, 22.6413, 57.4175, 83.2666, 61.2322]


def regression(u, y, na, nb, nk):
    """Return regressors and observations, row by row from the definition (eq. 5.1)."""
    rows = range(max(na, nb + nk - 1), len(y))
    phi = [[-y[t - k] for k in range(1, na + 1)] + [u[t - nk - k] for k in range(nb)] for t in rows]
    return np.array(phi), np.array([y[t] for t in rows])


def held(numerator, denominator, interval_s):
    """Discretize with zero-order hold: coefficients of B and A in powers of the delay."""
    denominator = np.asarray(denominator) / denominator[0]
    through = numerator[0] if len(numerator) == len(denominator) else 0.0
    n = len(denominator) - 1
    a = np.zeros((n + 1, n + 1))
    a[0, :n] = -denominator[1:]
    a[1:n, : n - 1] = np.eye(n - 1)
    a[0, n] = 1.0  # the input, held
    c = (np.polysub(numerator, through * denominator))[-n:]
    # exp(A T) by Taylor series of a thousandth of it, ten times squared: terms beyond the 14th
    # are below 1e-16.
    exponential, term = np.eye(n + 1), np.eye(n + 1)
    for k in range(1, 15):
        term = term @ a * (interval_s / 1024) / k
        exponential = exponential + term
    for _ in range(10):
        exponential = exponential @ exponential
    transition, gain = exponential[:n, :n], exponential[:n, n:]
    past = np.poly(transition)
    # det(zI − A + g c) = det(zI − A) (1 + c (zI − A)⁻¹ g)
    return np.poly(transition - gain @ c[None, :]) - past + through * past, past


def response(b, a, u):
    y = np.zeros_like(u)
    for t in range(len(u)):
        y[t] = sum(b[k] * u[t - k] for k in range(min(t + 1, len(b))))
        y[t] -= sum(a[k] * y[t - k] for k in range(1, min(t + 1, len(a))))
    return y


def noisy_second_order(rows=400, seed=3):
    random = np.random.default_rng(seed)
    u = 0.03 * np.sign(random.standard_normal(rows))
    y = response([0.0, 0.08, 0.05], [1.0, -1.5, 0.65], u)
    return u, y + 1e-3 * random.standard_normal(rows)


@pytest.mark.parametrize(
    ("na", "nb", "nk"),
    [(2, 2, 1), (5, 6, 0), (5, 5, 1), (0, 4, 0), (3, 1, 7), (8, 8, 2), (20, 20, 1), (1, 1, 48)],
)
def test_the_same_as_numpy_on_the_same_rows(na, nb, nk):
    u, y = noisy_second_order()
    phi, observed = regression(u, y, na, nb, nk)
    theta, _, _, singular = np.linalg.lstsq(phi, observed, rcond=None)
    freedom = len(observed) - na - nb
    variance = np.sum((observed - phi @ theta) ** 2) / freedom
    covariance = variance * np.linalg.inv(phi.T @ phi)
    model = cgheight.arx(u, y, na, nb, nk, 0.05)
    # The inverse of the normal equations loses ε cond², which is at most 1e-9 here (checked).
    assert EPSILON * (singular[0] / singular[-1]) ** 2 < 1e-9
    found = np.concatenate([model.a[1:], model.b[nk:]])
    assert np.max(np.abs(found - theta)) <= 1e-8 * np.max(np.abs(theta))
    assert np.max(np.abs(model.covariance - covariance)) <= 1e-8 * np.max(np.abs(covariance))
    assert model.noise_variance == pytest.approx(variance, rel=1e-8)
    fit = 100 * (1 - np.sqrt(variance / np.var(observed)))
    assert model.fit_percent == pytest.approx(fit, rel=1e-8, abs=1e-6)
    assert model.rows == len(observed)
    assert model.a[0] == 1.0
    assert (len(model.a), len(model.b)) == (na + 1, nk + nb)
    assert np.all(model.b[:nk] == 0.0)
    # Gain and its first-order standard deviation from the derivatives of B(1)/A(1).
    gain = np.sum(theta[na:]) / (1 + np.sum(theta[:na]))
    assert model.dc_gain == pytest.approx(gain, rel=1e-8)
    gradient = np.array([-gain] * na + [1.0] * nb) / (1 + np.sum(theta[:na]))
    assert model.dc_gain_sd == pytest.approx(np.sqrt(gradient @ covariance @ gradient), rel=1e-7)


@pytest.mark.parametrize("name", ["second_order", "fifth_order"])
def test_the_same_as_octave(name):
    case = CASES[name]
    data = np.genfromtxt(FIXTURES / "arx" / f"{name}_input.csv", delimiter=",", names=True)
    with (FIXTURES / "arx" / f"{name}_expected.csv").open() as file:
        expected = {row["name"]: float(row["value"]) for row in csv.DictReader(file)}
    model = cgheight.arx(data["u"], data["y"], **case["orders"], ts=case["interval_s"])
    found = {f"a{k}": value for k, value in enumerate(model.a)}
    found |= {f"b{k}": value for k, value in enumerate(model.b)}
    assert found.keys() == expected.keys()
    for letter in "ab":
        names = [key for key in expected if key[0] == letter]
        size = max(abs(expected[key]) for key in names)
        assert all(abs(found[key] - expected[key]) <= CASES["tolerance"] * size for key in names)
    assert model.rows == case["rows"]


@pytest.mark.parametrize("through", [True, False])
def test_the_reduced_model_is_recovered_from_its_own_response(through):
    ts = 0.05
    numerator = (
        NUMERATOR if through else np.polysub(NUMERATOR, NUMERATOR[0] * np.array(DENOMINATOR))[1:]
    )
    na, nb, nk = (5, 6, 0) if through else (5, 5, 1)
    b, a = held(numerator, DENOMINATOR, ts)
    # A pseudo-random binary signal; each value is held for four samples.
    u = 0.02 * np.repeat(np.sign(np.random.default_rng(12).standard_normal(200)), 4)
    y = response(b, a, u)
    model = cgheight.arx(u, y, na, nb, nk, ts)
    # Least squares lose ε cond of the regressors. The recursion for y rounds once for each of its
    # 12 terms, which has the effect of noise of the same size.
    phi, _ = regression(u, y, na, nb, nk)
    tolerance = 12 * EPSILON * np.linalg.cond(phi)
    assert tolerance < 1e-6
    assert np.max(np.abs(model.a - a)) <= tolerance * np.max(np.abs(a))
    assert np.max(np.abs(model.b - b)) <= tolerance * np.max(np.abs(a))
    exact = numerator[-1] / DENOMINATOR[-1]
    # The gain divides by A(1), which is small compared with the coefficients.
    assert model.dc_gain == pytest.approx(exact, rel=tolerance * np.max(np.abs(a)) / np.sum(a))
    if through:
        assert round(model.dc_gain, 4) == 0.8456  # as printed


@given(factor=st.floats(1e-3, 1e3), negative=st.booleans(), seed=st.integers(0, 50))
@settings(max_examples=60, deadline=None)
def test_scaling_the_output_scales_the_gain(factor, negative, seed):
    factor = -factor if negative else factor
    u, y = noisy_second_order(200, seed)
    plain = cgheight.arx(u, y, 2, 2, 1, 0.05)
    scaled = cgheight.arx(u, factor * y, 2, 2, 1, 0.05)
    # Rounding of c y: ε times the condition number, which scaling changes by up to c.
    phi, _ = regression(u, factor * y, 2, 2, 1)
    tolerance = 100 * EPSILON * np.linalg.cond(phi)
    assert tolerance < 1e-7
    assert scaled.dc_gain == pytest.approx(factor * plain.dc_gain, rel=tolerance)
    assert scaled.dc_gain_sd == pytest.approx(abs(factor) * plain.dc_gain_sd, rel=tolerance)


@given(factor=st.floats(0.5, 2.0))
@settings(max_examples=20, deadline=None)
def test_scaling_the_roll_angle_scales_the_ratio_of_a_log(factor):
    vehicle = cgheight.Vehicle.load(FIXTURES / "vehicles" / "kraz.toml")
    signals = read(ONE_TURN)
    plain = cgheight.estimate(**signals, vehicle=vehicle, method="arx", channel="steer")
    signals["roll_rad"] = factor * signals["roll_rad"]
    scaled = cgheight.estimate(**signals, vehicle=vehicle, method="arx", channel="steer")
    assert len(plain.maneuvers) == len(scaled.maneuvers) == 1
    # Rounding of c φ: ε times the condition number of 4e6, with a margin of 25.
    expected = factor * plain.maneuvers[0].ratio
    assert scaled.maneuvers[0].ratio == pytest.approx(expected, rel=1e8 * EPSILON)


def test_a_model_shows_itself():
    u, y = noisy_second_order()
    model = cgheight.arx(u.tolist(), y.tolist(), 2, 2, 1, 0.05)
    assert repr(model).startswith("ArxModel([2 2 1], 0.05 s, DC gain ")
    assert (model.na, model.nb, model.nk, model.ts) == (2, 2, 1, 0.05)
    with pytest.raises(AttributeError):
        model.rows = 1
