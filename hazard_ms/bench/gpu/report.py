"""The report of `hazard-ms gpu-check`: a page in Markdown that grows part by part, so that a break costs one part."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from hazard_ms.bench.gpu.apart import StoppedError, apart
from hazard_ms.bench.gpu.comparison import CHECKED, differences_table, kept
from hazard_ms.bench.gpu.gpu_tests import gpu_tests
from hazard_ms.bench.gpu.rates import FRAMES, PICTURES, SIDE, STATE, WARM_UP, Rate, growth, rates_table
from hazard_ms.bench.gpu.waits import waits_table
from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.report import machine_line
from hazard_ms.machine.files import make_folder, write
from hazard_ms.spec.checks import one_of

SIZES = (1, 4, 16, 64, 256, 1024, 4096)  # environments of a batch
MOST_DRAWN = 256  # environments that draw [ours]
WAITING = 16  # environments of the batch whose waits are counted [ours]
PARTS = ("tests", "state", "pictures", "comparison", "waits")
HEAD = """---
orphan: true
---

# On a GPU

Made by `./run gpu-check`, which docs/speed.md describes. Times belong to the machine that is named here.

"""


class Page:
    """The report, which is written anew with every line that is added."""

    def __init__(self, output: Path, simulator: str, budget: float, seed: int) -> None:
        self.simulator, self.seed = simulator, seed
        self.faults = 0
        self._output, self._budget, self._text = output, budget, HEAD
        make_folder(output.parent)

    def add(self, text: str) -> None:
        """Print a paragraph, and write it at the end of the page."""
        print(text + "\n", flush=True)
        self._text += text + "\n\n"
        write(self._output, self._text.rstrip() + "\n")

    def measured(self, job: str, **words: Any) -> Any:
        """The answer of a job in a process of its own; what the simulator complained of goes on the page.

        Raises StoppedError where the job has none.
        """
        made = apart(job, self._budget, seed=self.seed, **words)
        for text, count in made.complaints.items():
            self.add(f"The simulator complained {count} times ({_words(words)}): {text}")
        return made.value

    def stopped(self, error: StoppedError) -> None:
        """Say why a measurement stopped; what is no limit of the machine or of time is a fault."""
        self.faults += not error.limit
        self.add(f"Stopped at {error}." if error.limit else f"**Failed**: {error}.")


def report(
    output: Path,
    env_ids: Sequence[str],
    parts: Sequence[str] = PARTS,
    sizes: Sequence[int] = SIZES,
    budget: float = 300.0,
    seed: int = 0,
    simulator: str = "gpu",
) -> int:
    """Measure the `parts` for all tasks, write the page `output`; return how many of them failed.

    Every measurement may take `budget` seconds; batches have `sizes` environments, in rising order. Raises ValueError
    for unknown names, numbers that are not allowed, and a page that cannot be written.
    """
    for env_id in env_ids:
        EnvOptions(env_id).check()
    for part in parts:
        one_of(part, PARTS, "part")
    if not sizes:
        raise ValueError("most must be at least 1, got no number of environments to measure")
    if not budget > 0:
        raise ValueError(f"budget must be positive, got {budget}")
    page = Page(output, simulator, budget, seed)
    page.add(machine_line())
    page.add(f"Preset paper, seed {seed}. A measurement may take {budget:g} s, the start of its process included.")
    makers: dict[str, Callable[[], None]] = {
        "tests": partial(_tests, page),
        "state": partial(_rates, page, env_ids, STATE, sizes),
        "pictures": partial(_rates, page, env_ids, PICTURES, [n for n in sizes if n <= MOST_DRAWN]),
        "comparison": partial(_comparison, page, env_ids),
        "waits": partial(_waits, page, env_ids, min(WAITING, max(sizes))),
    }
    for part, make in makers.items():
        if part in parts:
            make()
    return page.faults


def _tests(page: Page) -> None:
    page.add("## Tests that need a GPU")
    said, passed = gpu_tests()
    page.faults += not passed
    page.add(said)


def _rates(page: Page, env_ids: Sequence[str], obs_mode: str, sizes: Sequence[int]) -> None:
    what = "state observations" if obs_mode == STATE else f"{obs_mode} of {SIDE} pixels"
    page.add(f"## Many environments in one batch: {what}")
    page.add(f"Wall time under random motion of the base, means of {FRAMES} frames after {WARM_UP}.")
    for env_id in env_ids:
        page.add(f"### {env_id}, {what}")

        def measure(size: int, env_id: str = env_id) -> Rate:
            job = {"env_id": env_id, "num_envs": size, "obs_mode": obs_mode, "simulator": page.simulator}
            made = Rate(**page.measured("rate", **job))
            print(f"a batch of {size:,}: {made.frames_per_second:,.0f} frames/s", flush=True)
            return made

        rates, stopped = growth(sizes, measure)
        if rates:
            page.add(rates_table(rates))
        if stopped is not None:
            page.stopped(stopped)


def _comparison(page: Page, env_ids: Sequence[str]) -> None:
    page.add("## One environment beside the same on the CPU")
    page.add(
        "One seed and the same actions. Largest differences after as many frames; of whole numbers and masks, how many "
        "entries differ."
    )
    for env_id, (title, pair) in _each(env_ids, page.simulator):
        page.add(f"### {env_id}, {title}")
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder) / f"{k}.npz" for k in range(2)]
            try:
                for file, simulator in zip(files, pair, strict=True):
                    words = {"env_id": env_id, "simulator": simulator, "checked": CHECKED}
                    page.measured("course", file=str(file), **words)
                page.add(differences_table(*map(kept, files)))
            except StoppedError as error:
                page.stopped(StoppedError(f"{env_id}: {error}", error.limit))


def _each(env_ids: Sequence[str], simulator: str) -> Iterator[tuple[str, tuple[str, tuple[str, str]]]]:
    for env_id in env_ids:
        yield env_id, (f"{simulator} and cpu", (simulator, "cpu"))
        yield env_id, (f"{simulator} twice", (simulator, simulator))


def _waits(page: Page, env_ids: Sequence[str], num_envs: int) -> None:
    page.add("## Where the host waits for the GPU")
    page.add(
        f"Waits per frame that torch warns of in a batch of {num_envs}, by the line that waits and the line of this "
        "package that led to it. Waits inside PhysX and Warp are not among them."
    )
    for env_id in env_ids:
        page.add(f"### {env_id}, waits")
        try:
            words = {"env_id": env_id, "num_envs": num_envs, "simulator": page.simulator}
            found = page.measured("waits", **words)
        except StoppedError as error:
            page.stopped(StoppedError(f"{env_id}: {error}", error.limit))
            continue
        total = sum(found["places"].values())
        page.add(f"{total:.2f} waits a frame, counted over {found['frames']} frames.")
        if total:
            page.add(waits_table(found["places"]))


def _words(words: dict[str, Any]) -> str:
    return ", ".join(str(words[name]) for name in ("num_envs", "simulator") if name in words)
