"""Every model takes the steps that are kept in ``golden/steps.npz``; ``tools/golden_models.py`` writes them."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from crowdbot import models
from crowdbot.core import builtin_classes
from crowdbot.models import CrowdModel

FILE = Path(__file__).with_name("golden") / "steps.npz"
NAMES = sorted({name.split(".", 1)[1] for name in np.load(FILE, allow_pickle=False).files})


@pytest.fixture(scope="module")
def golden() -> ModuleType:
    path = Path(__file__).parents[2] / "tools" / "golden_models.py"
    spec = importlib.util.spec_from_file_location("golden_models", path)
    assert spec is not None
    assert spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


@pytest.mark.parametrize("name", NAMES)
def test_steps_equal_the_reference(golden: ModuleType, name: str) -> None:
    with np.load(FILE, allow_pickle=False) as reference:
        for scene in golden.SCENES:
            np.testing.assert_allclose(
                golden.steps(scene, name), reference[f"{scene}.{name}"], rtol=1e-6, atol=1e-7, err_msg=scene
            )


def test_every_model_and_variant_has_reference_steps(golden: ModuleType) -> None:
    assert sorted(golden.cases((1, 30))) == NAMES
    for name, kind in builtin_classes(models, CrowdModel).items():
        assert name in NAMES
        variants = getattr(__import__(kind.__module__, fromlist=["VARIANTS"]), "VARIANTS", ())
        assert all(f"{name}-{variant}" in NAMES for variant in variants[1:])
