"""Searches and fits give the results that are kept in ``golden/searches.npz``."""

from __future__ import annotations

import numpy as np
import pytest
from golden_searches import FILE, SEARCHES, compute


@pytest.fixture(scope="module")
def computed() -> dict[str, np.ndarray]:
    return compute()


@pytest.mark.parametrize("name", [*SEARCHES, "fit", "prior", "shared"])
def test_results_equal_the_reference(name: str, computed: dict[str, np.ndarray]) -> None:
    with np.load(FILE, allow_pickle=False) as reference:
        keys = [key for key in reference.files if key.startswith(f"{name}.")]
        assert keys == [key for key in computed if key.startswith(f"{name}.")]
        assert keys
        for key in keys:
            np.testing.assert_allclose(computed[key], reference[key], rtol=1e-7, atol=1e-9, err_msg=key)
