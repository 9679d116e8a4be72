"""Orders, residuals, frequency responses, and python-control."""

from __future__ import annotations

import control
import numpy as np
import pytest
import scipy.signal

import cgheight
from test_arx import noisy_second_order, regression, response


@pytest.fixture(scope="module")
def second_order():
    """Return u and y of a known [2 2 1] with white equation error."""
    random = np.random.default_rng(8)
    u = random.standard_normal(4000)
    e = 0.2 * random.standard_normal(4000)
    a = [1.0, -1.5, 0.7]
    y = scipy.signal.lfilter([0.0, 1.0, 0.5], a, u) + scipy.signal.lfilter([1.0], a, e)
    return u, y


def test_orders_are_scored_as_by_hand_on_the_same_rows(second_order):
    u, y = (signal[:300] for signal in second_order)
    found = cgheight.select_order(u, y, 0.05, na=(1, 2, 4), nb=(1, 2), nk=(0, 1), criterion="aic")
    for k, (na, nb, nk) in enumerate(zip(found.na, found.nb, found.nk, strict=True)):
        phi, observed = regression(u, y, na, nb, nk)
        phi, observed = phi[-296:], observed[-296:]  # the longest memory is 4
        rest = observed - phi @ np.linalg.lstsq(phi, observed, rcond=None)[0]
        loss, d = np.mean(rest**2), na + nb
        assert found.loss[k] == pytest.approx(loss, rel=1e-9)
        assert found.aic[k] == pytest.approx(296 * np.log(loss) + 2 * d, rel=1e-9)
        assert found.bic[k] == pytest.approx(296 * np.log(loss) + d * np.log(296), rel=1e-9)
    frame = found.to_frame()
    assert frame.aic.is_monotonic_increasing
    best = frame.iloc[0]
    assert (found.model.na, found.model.nb, found.model.nk) == (best.na, best.nb, best.nk)


def test_schwarz_finds_the_true_order_and_validation_does_not_fall_below_it(second_order):
    u, y = second_order
    found = cgheight.select_order(u[:2000], y[:2000], 0.05)
    assert (found.model.na, found.model.nb, found.model.nk) == (2, 2, 1)
    assert repr(found) == "OrderSelection([2 2 1] by bic of 64 tried)"
    assert "[2 2 1]" in found._repr_html_()
    other = cgheight.select_order(
        u[:2000], y[:2000], 0.05, criterion="validation", validation=(u[2000:], y[2000:])
    )
    assert other.model.na >= 2
    assert other.model.nb >= 2
    # The noise remains; its variance scatters by sqrt(2/2000), 4 sd.
    assert other.validation_loss.min() == pytest.approx(0.04, rel=4 * np.sqrt(2 / 2000))


def test_orders_that_cannot_be_are_refused(second_order):
    u, y = second_order
    with pytest.raises(ValueError, match="criterion is 'best'"):
        cgheight.select_order(u, y, 0.05, criterion="best")
    with pytest.raises(ValueError, match="needs another log"):
        cgheight.select_order(u, y, 0.05, criterion="validation")
    with pytest.raises(ValueError, match="no orders to try"):
        cgheight.select_order(u, y, 0.05, na=())
    with pytest.raises(ValueError, match="none of these models"):
        cgheight.select_order(np.zeros(100), np.zeros(100), 0.05, na=(1,), nb=(1,))


def test_residuals_are_what_the_regression_leaves():
    u, y = noisy_second_order()
    for orders in ((2, 2, 1), (0, 3, 0), (1, 2, 5)):
        model = cgheight.arx(u, y, *orders, 0.05)
        phi, observed = regression(u, y, *orders)
        theta = np.concatenate([model.a[1:], model.b[model.nk :]])
        # Rounding: ε times the terms of a row.
        assert np.max(np.abs(model.residuals(u, y) - (observed - phi @ theta))) < 1e-15
    with pytest.raises(ValueError, match="this model needs 7 or more"):
        model.residuals(u[:3], y[:3])
    with pytest.raises(ValueError, match="the same length"):
        model.residuals(u, y[:-1])


def test_the_frequency_response_is_scipys_and_its_covariance_that_of_draws():
    u, y = noisy_second_order(2000)
    model = cgheight.arx(u, y, 2, 2, 1, 0.05)
    omega = np.array([0.5, 2.0, 10.0, 40.0])
    value, covariance = model.response(omega)
    _, expected = scipy.signal.freqz(model.b, model.a, worN=omega * model.ts)
    assert value == pytest.approx(expected, rel=1e-12)
    assert model.transfer_function.response(omega) == pytest.approx(expected, rel=1e-9)
    random = np.random.default_rng(2)
    theta = np.concatenate([model.a[1:], model.b[1:]])
    # A hundredth of the model's standard deviation, so that the first order is accurate.
    draws = random.multivariate_normal(theta, 1e-4 * model.covariance, 4000)
    delay = np.exp(-1j * np.outer(omega * model.ts, np.arange(3)))
    spread = np.array([
        delay[:, 1:] @ one[2:] / (1 + delay[:, 1:] @ one[:2]) for one in draws
    ])  # fmt: skip
    for k in range(len(omega)):
        drawn = np.cov(spread[:, k].real, spread[:, k].imag)
        # A covariance of 4000 draws scatters by sqrt(2/4000), 5 sd.
        size = np.sqrt(np.outer(np.diag(drawn), np.diag(drawn)))
        assert np.all(np.abs(1e-4 * covariance[k] - drawn) < 5 * np.sqrt(2 / 4000) * size)
    with pytest.raises(ValueError, match="Nyquist"):
        model.response([100.0])


@pytest.mark.parametrize("of", ["linear", "reduced", "arx", "roots"])
def test_the_same_response_in_python_control_and_back(of, baseline):
    linear = cgheight.linear_model(baseline)
    u, y = noisy_second_order()
    model = {
        "linear": linear,
        "reduced": linear.reduced,
        "arx": cgheight.arx(u, y, 2, 2, 1, 0.05),
        "roots": cgheight.TransferFunction.from_polynomials([2.0, 1.0], [1.0, 3.0, 5.0]),
    }[of]
    own = model if of == "roots" else model.transfer_function
    system = model.to_control()
    omega = np.array([0.1, 1.0, 5.0, 20.0])
    expected = own.response(omega)
    there = np.squeeze(system(1j * omega if own.ts is None else np.exp(1j * omega * own.ts)))
    # Order 18 from state space and from roots: 1e-6 is ε times the condition of the eigenvalues.
    assert there == pytest.approx(expected, rel=1e-6)
    back = cgheight.TransferFunction.from_control(system)
    assert back.ts == own.ts
    assert back.response(omega) == pytest.approx(expected, rel=1e-6)
    assert back.dc_gain == pytest.approx(model.dc_gain if of == "arx" else own.dc_gain, rel=1e-6)
    if of == "linear":
        assert system.input_labels == ["steer_rad"]
        assert own.dc_gain == pytest.approx(linear.dc_gain, rel=1e-9)


def test_systems_without_a_definite_transfer_function_are_refused():
    two = control.ss(-np.eye(2), np.eye(2), np.eye(2), np.zeros((2, 2)))
    with pytest.raises(ValueError, match="2 inputs and 2 outputs"):
        cgheight.TransferFunction.from_control(two)
    with pytest.raises(ValueError, match="without a sampling interval"):
        cgheight.TransferFunction.from_control(control.tf([1.0], [1.0, 0.5], True))
    with pytest.raises(ValueError, match="the system is zero"):
        cgheight.TransferFunction.from_control(control.ss([[-1.0]], [[0.0]], [[1.0]], [[0.0]]))
    with pytest.raises(ValueError, match="nonzero"):
        cgheight.TransferFunction.from_polynomials([0.0], [1.0, 1.0])


def test_a_step_of_the_arx_in_python_control_is_the_recursion():
    u, y = noisy_second_order()
    model = cgheight.arx(u, y, 2, 2, 1, 0.05)
    _, stepped = control.forced_response(model.to_control(), inputs=np.ones(50))
    expected = response(model.b, model.a, np.ones(50))
    assert stepped == pytest.approx(expected, rel=1e-9)
    stable = model.transfer_function.is_stable
    assert stable == bool(np.all(np.abs(np.roots(model.a)) < 1))


def test_the_prediction_follows_the_roll_angle(kraz, turn):
    predicted = cgheight.predict_roll(turn, 1.70, vehicle=kraz)
    assert predicted.shape == turn["roll_rad"].shape
    # The uncertainty of the ratio in the vehicle file is 10 %, two sd.
    steady = slice(-300, None)
    ratio = np.mean(turn["roll_rad"][steady]) / np.mean(predicted[steady])
    assert ratio == pytest.approx(1.0, abs=0.2)
    higher = cgheight.predict_roll(turn, 2.0, vehicle=kraz)
    assert np.mean(higher[steady]) > 1.1 * np.mean(predicted[steady])
    with pytest.raises(ValueError, match="height_m is -1"):
        cgheight.predict_roll(turn, -1.0, vehicle=kraz)
    with pytest.raises(ValueError, match="lacks the input of the suspension channel"):
        cgheight.predict_roll(turn, 1.7, vehicle=kraz, channel="suspension")


def test_models_show_themselves(baseline):
    linear = cgheight.linear_model(baseline)
    assert "axle loads" in linear._repr_html_()
    assert "TransferFunction(" in repr(linear.transfer_function)
    u, y = noisy_second_order()
    text = cgheight.arx(u, y, 2, 2, 1, 0.05)._repr_html_()
    assert "<td>a2</td>" in text
    assert "<td>b1</td>" in text
