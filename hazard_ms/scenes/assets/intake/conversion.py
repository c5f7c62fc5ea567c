"""Runs the conversion of a model in a process of its own, and draws the result."""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from hazard_ms.machine.processes import environment
from hazard_ms.scenes.assets.intake.model import Model
from hazard_ms.scenes.assets.intake.worker import PROCESSOR_TIME, UNWRITABLE
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.foreign.files import printable

HANGING = 3600.0  # when a conversion counts as hanging [s]; a busy machine may take long for a good model [ours]
THREADS = "2"  # of each library: memory of threads counts, too [ours]


def convert(model: Model, made: Path, size: float | None) -> dict[str, Any]:
    """Convert a model into the folder `made`, in a process of its own, and return what was measured on it.

    Raises ValueError with its message, or if it crashed, hung, or needed more processor time than is allowed;
    OSError where its files could not be written.
    """
    order = {**dataclasses.asdict(model), "size": size, "kind": CATEGORIES[model.category].kind}
    package = str(Path(__file__).resolve().parents[4])
    path = os.pathsep.join(p for p in (package, os.environ.get("PYTHONPATH", "")) if p)
    what = printable(Path(model.parts[0].file).name)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "hazard_ms.scenes.assets.intake.worker"],
            input=json.dumps(order),
            capture_output=True,
            text=True,
            errors="replace",
            cwd=made,
            env={**environment(), "PYTHONPATH": path, "OMP_NUM_THREADS": THREADS, "OPENBLAS_NUM_THREADS": THREADS},
            timeout=HANGING,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"{what} must be converted within {HANGING:.0f} s, got no result: simplify it first") from None
    if done.returncode == -signal.SIGXCPU:
        raise ValueError(
            f"{what} must be converted within {PROCESSOR_TIME} s of processor time, got no result: simplify it first"
        )
    facts = made / "facts.json"
    last = printable((done.stderr.strip().splitlines() or ["no message"])[-1])
    if done.returncode == UNWRITABLE:
        raise OSError(last)
    if done.returncode != 0 or not facts.is_file():
        raise ValueError(
            f"{what} could not be converted: the worker ended with exit code {done.returncode}: {last:.300}"
        )
    found: dict[str, Any] = json.loads(facts.read_text())
    facts.unlink()
    if "refused" in found:
        raise ValueError(f"{what}: {found['refused']}" if what not in found["refused"] else found["refused"])
    return found


def preview(row: dict[str, Any], made: Path) -> None:
    """Draw the model of a row beside its files in the folder `made`, if this machine can draw."""
    from hazard_ms.machine.render_backend import backend

    if backend() == "none":
        return
    import cv2

    from hazard_ms.scenes.assets.contact_sheet import Studio, captioned

    shown = Asset(
        row["id"],
        row["kind"],
        row["category"],
        str(made / "model.glb"),
        row["licence"],
        row["author"],
        row["source"],
        row["changes"],
        extent=tuple(row["extent"]),
        mass=row["mass"],
        faces=row["faces"],
    )
    cv2.imwrite(str(made / "preview.png"), captioned(Studio().picture(shown), shown)[..., ::-1])
