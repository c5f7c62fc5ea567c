"""Packages that choose instructions of the processor are told to take AVX2, where it is, before they are loaded."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hazard_ms.spec.registry.instructions import CHOICES, agree

ASK = (
    "{}import os, numpy, torch\n"
    "from numpy._core._multiarray_umath import __cpu_features__ as has\n"
    "print(torch.backends.cpu.get_cpu_capability(), has['X86_V4'] or has['AVX512_ICL'])"
)
WITH = "flags : fpu fma avx avx2 avx512f\n"


@pytest.fixture
def none_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in CHOICES:
        monkeypatch.setenv(name, "")  # so that it is put back
        monkeypatch.delenv(name)


@pytest.mark.usefixtures("none_chosen")
@pytest.mark.parametrize("flags", ["flags : fpu sse2 avx avx512f\n", "flags : avx2x fma\n", "Features : asimd\n", None])
def test_a_processor_without_avx2_keeps_its_own(flags: str | None, tmp_path: Path) -> None:
    if flags is not None:
        (tmp_path / "cpuinfo").write_text(flags)
    agree(tmp_path / "cpuinfo")
    assert not set(CHOICES) & set(os.environ)


@pytest.mark.usefixtures("none_chosen")
def test_what_the_user_has_chosen_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cpuinfo").write_text(f"processor : 0\n{WITH}")
    monkeypatch.setenv("ATEN_CPU_CAPABILITY", "default")
    agree(tmp_path / "cpuinfo")
    assert os.environ["ATEN_CPU_CAPABILITY"] == "default"
    assert os.environ["OPENBLAS_CORETYPE"] == "Haswell" and "X86_V4" in os.environ["NPY_DISABLE_CPU_FEATURES"]


@pytest.mark.skipif(" avx2 " not in Path("/proc/cpuinfo").read_text(), reason="a processor without AVX2")
@pytest.mark.parametrize(("first", "numpy"), [("import hazard_ms\n", True), ("import torch, hazard_ms\n", False)])
def test_torch_does_as_told_also_where_it_was_there_before_and_numpy_where_it_was_not(first: str, numpy: bool) -> None:
    """Torch loads numpy, which has chosen by then; what it computes is the same with all instructions."""
    environ = {name: value for name, value in os.environ.items() if name not in CHOICES}
    child = subprocess.run(
        [sys.executable, "-c", ASK.format(first)], capture_output=True, text=True, check=True, env=environ
    )
    assert child.stdout.split()[: 1 + numpy] == ["AVX2", "False"][: 1 + numpy]
