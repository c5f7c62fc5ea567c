"""A small dataset that all tests of perception share."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.workers import SILENCE
from hazard_ms.perception.capture import CaptureJob, assemble, attempt
from hazard_ms.perception.options import CaptureOptions

SCENE = "kitchen_a/03"


@pytest.fixture(scope="session")
def options(tmp_path_factory: pytest.TempPathFactory) -> CaptureOptions:
    """A capture of eight pictures of one burning kitchen."""
    folder = tmp_path_factory.mktemp("perception")
    return CaptureOptions(env=EnvOptions(), scenes=(SCENE,), per_scene=12, size=96, output=folder)


@pytest.fixture(scope="session")
def dataset(options: CaptureOptions) -> Path:
    """That dataset, taken in this process. Tests must not change it."""
    (options.dataset / options.env.split).mkdir(parents=True)
    outcome = attempt(CaptureJob(options.episode(SCENE, 0), SILENCE, capture=options), lambda word: None)
    assert not outcome.error, outcome.error
    assert assemble(options.dataset, options.env.split) == options.per_scene
    return options.dataset
