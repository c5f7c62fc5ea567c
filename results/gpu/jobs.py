"""The measurements that run in processes of their own: `python -m results.gpu.jobs JSON`.

JSON has the name of a job, the file for its answer, and the job's keywords.
"""

from __future__ import annotations

import dataclasses
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from hazard_ms.spec.storage.files import write
from results.gpu.needs import without_gpu


def rate_job(**keywords: Any) -> Any:
    """See `results.gpu.rates.rate`."""
    from results.gpu.rates import rate

    return dataclasses.asdict(rate(**keywords))


def course_job(file: str, **keywords: Any) -> Any:
    """See `results.gpu.comparison.course`, which goes into `file`."""
    from results.gpu.comparison import course, keep

    keep(Path(file), course(**keywords))


def waits_job(**keywords: Any) -> Any:
    """See `results.gpu.waits.waits`."""
    from results.gpu.waits import waits

    return waits(**keywords)


def laws_job(**keywords: Any) -> Any:
    """See `results.gpu.laws.laws`."""
    from results.gpu.laws import laws

    return laws(**keywords)


def looks_job(file: str, renderer: str, **keywords: Any) -> Any:
    """See `results.gpu.looks.looks`, whose pictures go into `file`. For the CPU the GPU is hidden.

    Raises ValueError where nothing can draw on the CPU.
    """
    if renderer == "cpu":
        if not (variables := without_gpu()):
            raise ValueError("drawing on the CPU needs the Vulkan driver lavapipe, which is not installed")
        os.environ.update(variables)
    from results.gpu.comparison import keep
    from results.gpu.looks import looks

    spans, pictures = looks(renderer=renderer, **keywords)
    keep(Path(file), pictures)
    return spans


def physics_job() -> Any:
    """Let SAPIEN turn to the GPU, for which it downloads a library once."""
    from sapien import physx

    physx.enable_gpu()
    physx.PhysxGpuSystem("cuda")


JOBS: dict[str, Callable[..., Any]] = {
    "rate": rate_job,
    "course": course_job,
    "waits": waits_job,
    "laws": laws_job,
    "looks": looks_job,
    "physics": physics_job,
}


def main(words: str) -> None:
    """Run one job and write its answer."""
    asked = json.loads(words)
    job, answer = JOBS[asked.pop("job")], Path(asked.pop("answer"))
    write(answer, json.dumps(job(**asked)))


if __name__ == "__main__":
    main(sys.argv[1])
