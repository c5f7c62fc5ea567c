"""What NumpyEnv hands out is the user's own: writing to it changes nothing, and nothing changes it."""

from __future__ import annotations

import numpy as np
import torch

from hazard_ms.env.wrappers import plain


def test_arrays_belong_to_whoever_gets_them() -> None:
    inner = {"tensor": torch.arange(6.0).reshape(1, 6), "array": np.arange(6.0).reshape(1, 6)}
    given = plain(inner)
    for name, numbers in inner.items():
        numbers[0, 0] = 9.0
        assert given[name].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
        given[name][1] = -7.0
        assert float(numbers[0, 1]) == 1.0


def test_what_has_no_axis_but_that_of_the_batch_is_a_number_of_python() -> None:
    given = plain(
        {"flag": torch.tensor([True]), "reward": torch.tensor([0.5]), "name": "fire", "frame": torch.tensor(3)}
    )
    assert given == {"flag": True, "reward": 0.5, "name": "fire", "frame": 3}
    assert [type(given[name]) for name in ("flag", "reward", "frame")] == [bool, float, int]
