"""Matrices of Chebyshev series are built once and kept, within a bound."""

from __future__ import annotations

import tracemalloc

import numpy as np

from puma_septic.piecewise import matrices


def test_matrices_of_ever_other_degrees_are_not_all_kept() -> None:
    """Two thousand sizings grew by 5 MB: each met degrees of its own, and 256 matrices of each kind were kept.

    The fifty that are asked for here have 50 MB.
    """
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        sizes = [matrices.grid(degree).nbytes for degree in range(150, 200)]
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert sum(sizes) > 40e6
    assert after - before < 5e6


def test_a_matrix_is_kept_until_it_is_put_out_and_then_built_alike() -> None:
    first = matrices.integral_matrix(9)
    assert matrices.integral_matrix(9) is first
    for degree in range(150, 160):  # each 0.7 to 0.8 MB
        matrices.grid(degree)
    assert matrices.integral_matrix(9) is not first
    np.testing.assert_array_equal(matrices.integral_matrix(9), first)


def test_a_matrix_in_use_outlives_larger_ones() -> None:
    first = matrices.integral_matrix(9)
    for degree in range(150, 160):
        matrices.grid(degree)
        matrices.integral_matrix(9)
    assert matrices.integral_matrix(9) is first
