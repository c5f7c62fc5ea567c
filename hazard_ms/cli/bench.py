"""The commands `hazard-ms bench` and `danger`; each imports what it needs when it is called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from hazard_ms.evaluation.choices import PRESETS, SEVERITIES, SPLITS, flag, offer
from hazard_ms.spec import registry

PICTURES_SHARE = 10  # frames for one picture: pictures take that much longer [ours]
FEWEST_PICTURES = 3  # of which a median is taken [ours]
OTHERS = ("stock",)  # what frames and resets can be compared with


def bench(
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")] = "HazardFire-v1",
    frames: int = 600,
    seed: Annotated[int, flag("-s")] = 0,
    physics: Annotated[str, offer(PRESETS)] = "paper",
    severity: Annotated[str, offer(SEVERITIES)] = "severe",
    episode: bool = True,
    effects: Annotated[bool, flag("--effects", old="looks")] = False,
    kernels: bool = False,
    pickups: bool = False,
    against: Annotated[str | None, offer(OTHERS)] = None,
    resets: bool = False,
    scaling: bool = False,
    vector: bool = False,
    serve: bool = False,
    minutes: float = 1.0,
    robot: Annotated[str, offer(registry.ROBOTS), flag("-r")] = "fetch",
    count: Annotated[int, flag("-n")] = 500,
    output: Annotated[Path | None, flag("-o", "--output", old="out")] = None,
) -> int:
    """Print where the time of a frame goes, phase by phase, and how long a greedy episode takes, on which machine.

    Args:
        env_id: Task.
        frames: Frames to average over.
        seed: Seed of the episode.
        physics: Preset of the hazards.
        severity: Strength of the hazards in the preset realistic.
        episode: Also play a whole greedy episode.
        effects: Only print what the effects of each mode cost in a picture.
        kernels: Only print what the laws of all hazards cost on one thread, for 1,024 environments and for 64.
        pickups: Only print how often picking up and putting away succeed, and how many frames they take.
        against: Only print what frames and resets of all tasks cost beside those of ManiSkill's own PickCube-v1.
        resets: Only print what 200 resets over 20 scenes cost, and whether episodes start as freshly built ones do.
        scaling: Only print how frames grow with the number of things, and with the size of pictures.
        vector: Only print the frames per second of environments in processes, one and several at once.
        serve: Only print what the page of `hazard-ms serve` costs: time to the first picture, pictures, memory.
        minutes: Time for which --serve plays [min].
        robot: Robot of --pickups and --resets.
        count: Number of targets that --pickups picks up.
        output: File for what each pick-up and drop of --pickups cost, one JSON object per line.
    """
    if kernels:
        from hazard_ms.validation.kernel_costs import report as report_kernels

        print(report_kernels())
    elif against:
        from hazard_ms.cli.costs.stock import report as report_stock

        print(report_stock(frames, seed))
    elif resets:
        from hazard_ms.cli.costs.resets import report as report_resets
        from hazard_ms.cli.costs.turns import Case

        print(report_resets([Case(env_id, robot, physics)]))
    elif scaling:
        from hazard_ms.cli.costs.scaling import report as report_scaling

        print(report_scaling(frames, seed, physics))
    elif pickups:
        _pickups(env_id, robot, count, seed, output)
    elif vector:
        from hazard_ms.cli.costs.vector import report as report_vector

        print(report_vector(env_id, frames, seed))
    elif serve:
        from hazard_ms.cli.costs.serving import report as report_serving

        print(report_serving(env_id, seed, minutes))
    elif effects:
        from hazard_ms.cli.costs.effects import report as report_effects

        print(report_effects(env_id, max(frames // PICTURES_SHARE, FEWEST_PICTURES), seed))
    else:
        from hazard_ms.cli.costs.frames import report

        print(report(env_id, frames, seed, episode, physics, severity))
    return 0


def danger(
    env_id: Annotated[tuple[str, ...], flag("-e")] = (),
    scenes: int = 25,
    split: Annotated[str, offer(SPLITS)] = "train",
    physics: tuple[str, ...] = PRESETS,
    severity: tuple[str, ...] = SEVERITIES,
    seed: Annotated[int, flag("-s")] = 0,
) -> int:
    """Print how many targets the hazards move and damage over time if nobody acts, for every preset and severity.

    Args:
        env_id: Tasks; by default fire, flood, wind and compound.
        scenes: Number of scenes per task.
        split: Split that the scenes come from.
        physics: Presets of the hazards: some of paper, shipped, realistic.
        severity: Strengths of the hazards in the preset realistic: some of moderate, severe, extreme.
        seed: Seed of the first scene; the others have the seeds after it.
    """
    from hazard_ms.sketch.rescues.danger import RESCUES, report

    for line in report(env_id or RESCUES, scenes, split, physics, severity, seed):
        print(line, flush=True)
    return 0


def _pickups(env_id: str, robot: str, count: int, seed: int, output: Path | None) -> None:
    from tqdm import tqdm

    from hazard_ms.cli.costs.pickups import handlings, lines, report
    from hazard_ms.spec.storage.files import drafts, make_folder

    made = list(tqdm(handlings(env_id, robot, count, seed), desc=robot, mininterval=5.0))
    print(report(made))
    if output is not None:
        make_folder(output.parent)
        with drafts(output) as (file,):
            file.write(lines(made))
