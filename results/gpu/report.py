"""The report of `./run gpu-check`: a page in Markdown that grows part by part, so that a break costs one part."""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.report import machine_line
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.storage.files import make_folder, write
from results.gpu.apart import StoppedError, apart
from results.gpu.comparison import CHECKED, differences_table, kept
from results.gpu.gpu_tests import gpu_tests
from results.gpu.laws import COMPARED
from results.gpu.looks import SIDES, compare, looks_row, looks_table
from results.gpu.rates import FRAMES, PICTURES, SIDE, STATE, WARM_UP, Rate, growth, rates_table
from results.gpu.waits import waits_table

SIZES = (1, 4, 16, 64, 256, 1024, 4096)  # environments of a batch
MOST_DRAWN = 256  # environments that draw [ours]
WAITING = 16  # environments of the batch whose waits are counted [ours]
PARTS = ("tests", "laws", "looks", "state", "pictures", "comparison", "waits")
PHYSX = ("state", "pictures", "comparison", "waits")  # which simulate on the GPU
LAWS = ("paper", "realistic")  # presets whose laws are measured: the third has the equations of the first
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
    lack: str = "",
) -> int:
    """Measure the `parts` for all tasks, write the page `output`; return how many of them failed.

    Every measurement may take `budget` seconds; batches have `sizes` environments, in rising order. `lack`: why nothing
    can be simulated on the GPU; the parts that do so then fail at once. Raises ValueError for unknown names, numbers
    that are not allowed, and a page that cannot be written.
    """
    for env_id in env_ids:
        EnvOptions(env_id).check()
    for part in parts:
        one_of(part, PARTS, "part")
    if not sizes:
        raise ValueError("most must be at least 1, the smallest batch that is measured")
    if not budget > 0:
        raise ValueError(f"budget must be positive, got {budget}")
    page = Page(output, simulator, budget, seed)
    page.add(machine_line())
    page.add(f"Preset paper, seed {seed}. A measurement may take {budget:g} s, the start of its process included.")
    makers: dict[str, Callable[[], None]] = {
        "tests": partial(_tests, page),
        "laws": partial(_laws, page, env_ids, sizes),
        "looks": partial(_looks, page, env_ids),
        "state": partial(_rates, page, env_ids, STATE, sizes),
        "pictures": partial(_rates, page, env_ids, PICTURES, [n for n in sizes if n <= MOST_DRAWN]),
        "comparison": partial(_comparison, page, env_ids),
        "waits": partial(_waits, page, env_ids, min(WAITING, max(sizes))),
    }
    out = [part for part in PHYSX if part in parts and lack]
    for part in (part for part in makers if part in parts and part not in out):
        makers[part]()
    if out:
        page.faults += len(out)
        page.add(f"**Left out**: {', '.join(out)}. This machine lacks {lack}.")
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


def _laws(page: Page, env_ids: Sequence[str], sizes: Sequence[int]) -> None:
    page.add("## The hazards of many environments, without a simulator")
    page.add(
        "Each in a scene of its own, in which nobody acts and nothing moves: hazards, forces before each physics step, "
        f"damage. Wall time, means of {FRAMES} frames after {WARM_UP}. Then {COMPARED} of them beside the same on the "
        "CPU, and twice on the GPU: largest differences after as many frames; of whole numbers and masks, how many "
        "entries differ. Waits are those of the host for the GPU that torch warns of."
    )
    for env_id, physics in itertools.product(env_ids, LAWS):
        page.add(f"### {env_id}, {physics}, hazards alone")
        words = {"env_id": env_id, "physics": physics, "sizes": list(sizes), "simulator": page.simulator}
        try:
            found = page.measured("laws", **words)
        except StoppedError as error:
            page.stopped(StoppedError(f"{env_id}, {physics}: {error}", error.limit))
            continue
        page.add(rates_table([Rate(**made) for made in found["rates"]]))
        if found["too_many"]:
            page.stopped(StoppedError(f"a batch of {found['too_many']:,}: the memory is exhausted", limit=True))
        for title, differences in found["differences"].items():
            page.add(f"{title}:\n\n{differences}")
        places = found["waits"]
        page.add(f"{sum(places.values()):.2f} waits a frame." + (f"\n\n{waits_table(places)}" if places else ""))


def _pair(page: Page, job: str, pair: tuple[str, str], **words: Any) -> str:
    """The table of differences of two courses that `job` records, one on each simulator of the `pair`."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.npz" for k in range(2)]
        for file, simulator in zip(files, pair, strict=True):
            page.measured(job, file=str(file), simulator=simulator, checked=CHECKED, **words)
        return differences_table(*map(kept, files))


def _looks(page: Page, env_ids: Sequence[str]) -> None:
    page.add("## One environment, simulated on the CPU and drawn on the GPU")
    page.add(
        "Median times of a look of the head camera (rgb, depth, segmentation) while the hazard goes on, and how it "
        "differs from the same look drawn on the CPU."
    )
    for env_id in env_ids:
        try:
            page.add(looks_table(_task_looks(page, env_id)))
        except StoppedError as error:
            page.stopped(StoppedError(f"{env_id}: {error}", error.limit))


def _task_looks(page: Page, env_id: str) -> list[list[str]]:
    """The rows of a task, one for each size. Where the CPU cannot draw, there is nothing to compare with."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.npz" for k in range(2)]
        words = {"env_id": env_id, "sides": list(SIDES)}
        here = page.measured("looks", file=str(files[0]), renderer=page.simulator, **words)
        try:
            there = page.measured("looks", file=str(files[1]), renderer="cpu", **words)
        except StoppedError as error:
            page.add(f"Nothing to compare {env_id} with, since the CPU drew nothing: {error}.")
            return [looks_row(env_id, side, span, None, None) for side, span in zip(SIDES, here, strict=True)]
        gpu, cpu = map(kept, files)
        return [looks_row(env_id, side, here[k], there[k], compare(side, gpu, cpu)) for k, side in enumerate(SIDES)]


def _comparison(page: Page, env_ids: Sequence[str]) -> None:
    page.add("## One environment beside the same on the CPU")
    page.add(
        "One seed and the same actions. Largest differences after as many frames; of whole numbers and masks, how many "
        "entries differ."
    )
    for env_id, (title, pair) in _each(env_ids, page.simulator):
        page.add(f"### {env_id}, {title}")
        try:
            page.add(_pair(page, "course", pair, env_id=env_id))
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
