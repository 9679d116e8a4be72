"""Transfer functions, and their conversion to and from python-control."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cgheight import _show
from cgheight._arrays import column
from cgheight._extras import need

_Array = NDArray[np.float64]
_ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TransferFunction:
    """A transfer function with one input and one output, given by its zeros and poles.

    Polynomial coefficients would be less accurate: at order 18 their roots lose six digits.

    Attributes
    ----------
    zeros, poles : complex array, shapes (m,), (n,)
        Roots of numerator and denominator, rad/s (in the z plane if discrete).
    gain : float
        Leading coefficient of the numerator divided by that of the denominator.
    ts : float or None
        Sampling interval, s; None for continuous time.
    """

    zeros: _ComplexArray
    poles: _ComplexArray
    gain: float
    ts: float | None = None

    @classmethod
    def from_polynomials(
        cls, numerator: ArrayLike, denominator: ArrayLike, *, ts: float | None = None
    ) -> Self:
        """Return the transfer function of two polynomials.

        Parameters
        ----------
        numerator, denominator : array, shape (m,) and (n,)
            Coefficients in descending powers of s, or of z if `ts` is given.
        ts : float, optional
            Sampling interval, s; continuous if absent.

        Returns
        -------
        TransferFunction

        Raises
        ------
        ValueError
            One of them is zero or not an array of numbers.
        """
        top = np.trim_zeros(column("numerator", numerator), "f")
        bottom = np.trim_zeros(column("denominator", denominator), "f")
        if not (top.size and bottom.size):
            raise ValueError("numerator and denominator must each have a nonzero coefficient")
        zeros, poles = np.roots(top).astype(complex), np.roots(bottom).astype(complex)
        return cls(zeros, poles, float(top[0] / bottom[0]), ts)

    @classmethod
    def from_control(cls, system: Any) -> Self:
        """Return the transfer function of a python-control object.

        Parameters
        ----------
        system : control.TransferFunction or control.StateSpace
            A system with one input and one output.

        Returns
        -------
        TransferFunction

        Raises
        ------
        ValueError
            The system has several inputs or outputs, no definite sampling interval, or is zero.
        """
        if (system.ninputs, system.noutputs) != (1, 1):
            raise ValueError(
                f"the system has {system.ninputs} inputs and {system.noutputs} outputs: "
                "select one pair, such as system[0, 0]"
            )
        if system.dt is True:
            raise ValueError("the system is discrete without a sampling interval: give it a dt")
        ts = float(system.dt) if system.dt else None
        zeros = np.asarray(system.zeros(), dtype=complex)
        zeros = zeros[np.isfinite(zeros)]
        poles = np.asarray(system.poles(), dtype=complex)
        # The gain follows from one value at a point that is away from all roots but of their size.
        size = 1.0 if ts else float(np.max(np.abs(np.concatenate([zeros, poles, [1.0]]))))
        point = 1.5 * size * np.exp(0.7j)
        value = complex(system(point)) * np.prod((point - poles) / size)
        gain = value / np.prod((point - zeros) / size) * size ** (len(poles) - len(zeros))
        if not np.isfinite(gain) or gain == 0:
            raise ValueError("the system is zero: its poles and zeros are not defined")
        return cls(zeros, poles, float(gain.real), ts)

    @property
    def numerator(self) -> _Array:
        """Coefficients in descending powers of s (z if discrete), shape (zeros + 1,)."""
        return self.gain * np.real(np.poly(self.zeros)).reshape(-1)

    @property
    def denominator(self) -> _Array:
        """Coefficients in descending powers of s (z if discrete); the first one is 1."""
        return np.real(np.poly(self.poles)).reshape(-1)

    @property
    def dc_gain(self) -> float:
        """Value at s = 0 (z = 1 if discrete), in units of output over input."""
        return float(self._at(np.array([0.0 if self.ts is None else 1.0], dtype=complex))[0].real)

    @property
    def is_stable(self) -> bool:
        """Whether every pole is in the left half plane (inside the unit circle if discrete)."""
        if self.ts is None:
            return bool(np.all(self.poles.real < 0))
        return bool(np.all(np.abs(self.poles) < 1))

    def response(self, frequency_radps: ArrayLike) -> _ComplexArray:
        """Return the frequency response.

        Parameters
        ----------
        frequency_radps : array, shape (n,)
            Angular frequencies, rad/s.

        Returns
        -------
        complex array, shape (n,)
            The response, in units of output over input.

        Raises
        ------
        ValueError
            `frequency_radps` is not an array of numbers.
        """
        points = 1j * column("frequency_radps", frequency_radps).astype(complex)
        return self._at(points if self.ts is None else np.exp(points * self.ts).astype(complex))

    def _at(self, points: _ComplexArray) -> _ComplexArray:
        # Multiply and divide in turn, so that neither product overflows.
        value = np.full(points.shape, self.gain, dtype=complex)
        with np.errstate(divide="ignore", invalid="ignore"):  # at a pole it is infinite
            for k in range(max(len(self.zeros), len(self.poles))):
                if k < len(self.zeros):
                    value *= points - self.zeros[k]
                if k < len(self.poles):
                    value /= points - self.poles[k]
        return value

    def to_control(self) -> Any:
        """Return a `control.TransferFunction`.

        Raises
        ------
        ImportError
            python-control is not installed.
        """
        dt = 0 if self.ts is None else self.ts
        return need("control", "control").zpk(self.zeros, self.poles, self.gain, dt=dt)

    def __repr__(self) -> str:
        time = "continuous" if self.ts is None else f"{self.ts:g} s"
        roots = f"{len(self.zeros)} zeros, {len(self.poles)} poles"
        return f"TransferFunction({roots}, {time}, DC gain {self.dc_gain:.4g})"

    def _repr_html_(self) -> str:
        def show(roots: _ComplexArray) -> str:
            return ", ".join(f"{root:.3g}" for root in roots) or "none"

        rows = [("zeros", show(self.zeros)), ("poles", show(self.poles))]
        rows.append(("gain", f"{self.gain:.5g}"))
        return _show.pairs(repr(self), rows)
