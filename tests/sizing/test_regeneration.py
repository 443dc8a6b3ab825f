"""What a bus takes up over a steady cycle, and what goes into the brake resistor, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from puma_septic.sizing._winding import regeneration


@pytest.mark.parametrize(
    ("flows", "storable", "periodic", "braked"),
    [
        # 1 J drawn, 3 J returned each cycle: after fifty cycles 100 J are full, and 2 J are burnt from then on.
        ([1.0, -3.0], 100.0, True, 2.0),
        # The first cycle alone stores all of it.
        ([1.0, -3.0], 100.0, False, 0.0),
        # 3 J drawn, 1 J returned: the bus is never full.
        ([3.0, -1.0], 100.0, True, 0.0),
        # No room for 4 of 5 J that come back at once, whatever is drawn afterwards.
        ([-5.0, 9.0], 1.0, True, 4.0),
        # A cycle that returns 1 J in all begins full: 4 J drawn leave room for 4 of 5.
        ([4.0, -5.0], 10.0, True, 1.0),
    ],
)
def test_a_steady_cycle_begins_with_what_the_one_before_leaves(
    flows: list[float], storable: float, periodic: bool, braked: float
) -> None:
    """A cycle that returns more than it draws was sized as if its bus were empty at the start: no resistor at all."""
    found = regeneration(np.array(flows), storable=storable, periodic=periodic)
    assert found.braked == pytest.approx(braked, abs=1e-12)


def test_without_a_bound_it_would_take_up_all_that_is_returned_at_once() -> None:
    assert regeneration(np.array([3.0, -2.0, 1.0, -1.5, 5.0]), storable=0.0, periodic=True).stored == 2.5
    assert regeneration(np.array([1.0, -3.0]), storable=100.0, periodic=True).stored == np.inf
