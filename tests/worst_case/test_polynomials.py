"""Polynomials of the pose: what is fitted is the function, and a box's control values hold what it has there."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from puma_septic.errors import ModelError
from puma_septic.validation import Array
from puma_septic.worst_case._polynomials import fitted

REGION = np.array([[-3.0, 3.0], [-1.0, 2.0], [0.2, 0.7]])
SLIDES = (False, False, True)


def smooth(q: Array) -> Array:
    """Degrees 1, 2 and 2; two quantities."""
    a, b, x = q.T
    return np.stack([np.cos(a) * np.sin(2 * b) * x**2 + 0.3 * np.sin(a), 1.0 + np.cos(b - a) * x], axis=-1)


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 2.0))
def test_no_pose_of_a_box_lies_outside_the_hull_of_its_control_values(seed: int, width: float) -> None:
    polynomial = fitted(smooth, REGION, SLIDES, degrees=(1, 2, 2), scale=1.0)
    rng = np.random.default_rng(seed)
    low = rng.uniform(-3, 3, 3)
    box = np.column_stack([low, low + width])
    values = smooth(rng.uniform(box[:, 0], box[:, 1], (200, 3)))
    control = polynomial.control_values(box[None])[0]
    for direction in rng.normal(size=(8, 2)):
        # Coefficients are of the order 1; x reaches 5 here, its square 25.
        assert (values @ direction).max() <= (control @ direction).max() + 1e-9


def test_control_values_come_to_the_values_as_a_box_shrinks() -> None:
    """Quadratically: halving a box brings them four times nearer."""
    polynomial = fitted(smooth, REGION, SLIDES, degrees=(1, 2, 2), scale=1.0)
    centre = np.array([0.4, 0.4, 0.5])  # on the crest of cos(b - a)
    errors = []
    for width in (0.2, 0.1, 0.05):
        box = np.column_stack([centre - width / 2, centre + width / 2])
        grid = np.stack(np.meshgrid(*np.linspace(*box.T, 21).T), axis=-1).reshape(-1, 3)
        errors.append(polynomial.control_values(box[None])[0, :, 1].max() - smooth(grid)[:, 1].max())
    assert 0 <= errors[2] < errors[1] < errors[0]
    assert errors[2] < errors[0] / 4


def test_what_is_no_polynomial_is_refused() -> None:
    """A joint that follows another at 1.5 times its angle has no period of a full turn."""
    with pytest.raises(ModelError, match="no polynomial of the joints' cosines and sines"):
        fitted(lambda q: np.cos(1.5 * q[:, :1]), REGION, SLIDES, degrees=(2, 0, 0), scale=1.0)


def test_joints_without_influence_are_left_out_and_what_they_could_add_is_kept() -> None:
    polynomial = fitted(
        lambda q: np.cos(q[:, :1]) + 1e-5 * np.sin(q[:, 1:2]), REGION, SLIDES, degrees=(1, 1, 0), scale=1.0
    )
    assert polynomial.joints == (0,)
    assert polynomial.remainder == pytest.approx([1e-5], rel=1e-6)
