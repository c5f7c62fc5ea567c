"""The commands `hazard-ms train ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from hazard_ms.evaluation.choices import PRESETS, flag, offer
from hazard_ms.spec import registry
from hazard_ms.spec.registry.version import __version__

if TYPE_CHECKING:
    from hazard_ms.learning.cloning import Student

ACTIONS = ("options", "paper")  # as hazard_ms.skills.options.choices has them; tests/cli compares them
VALIDATION = 1000  # number of the first scene whose Value chooses the best round; training stays below it [ours]
VALIDATION_SCENES = 24  # of that sort [ours]


def bc(
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")],
    output: Annotated[Path, flag("-o")],
    seed: int = 0,
    scenes: int = 225,
    rounds: int = 5,
    episodes: int = 1536,
    physics: Annotated[str, offer(PRESETS)] = "paper",
    workers: int = 0,
) -> int:
    """Train the policy of the agent `bc` by behaviour cloning in the sketch, in minutes on one core.

    It trains in generated scenes outside all splits, and keeps the best round. Score it with --agents bc:weights=FILE.

    Args:
        env_id: Task.
        output: Folder for bc_TASK.safetensors and bc_TASK.json.
        seed: Seed of all randomness.
        scenes: Number of training scenes.
        rounds: Rounds of labelling and training.
        episodes: Rescues labelled per round.
        physics: Preset of the hazards.
        workers: Processes that make scenes; 0: one per processor.
    """
    import torch

    from hazard_ms.learning.cloning import Student, train
    from hazard_ms.learning.scenes import generated
    from hazard_ms.sketch.scenes import SCENES, level_ranges, measures_of
    from hazard_ms.sketch.skill_times import load
    from hazard_ms.spec.checks import whole
    from hazard_ms.spec.storage.files import make_folder

    count = whole(scenes, 1, VALIDATION - SCENES, "scenes")
    whole(rounds, 1, 1000, "rounds")
    whole(episodes, 1, 10**7, "episodes")
    make_folder(output)
    student = Student(level_ranges(env_id, physics), whole(seed, 0, 2**31, "seed"), measures_of(env_id, physics))
    numbers = [*range(SCENES, SCENES + count), *range(VALIDATION, VALIDATION + VALIDATION_SCENES)]
    made = generated(env_id, physics, numbers, whole(workers, 0, 1000, "workers"))
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        done = train(student, made[:count], made[count:], load("fetch"), seed, rounds, episodes, print)
    finally:
        torch.set_num_threads(threads)
    command = f"train bc -e {env_id} --seed {seed} --scenes {scenes} --rounds {rounds} --episodes {episodes}"
    told = {"rounds": [vars(each) for each in done]}
    return _stored(student, output, env_id, f"{command} --physics {physics}", told)


def clone(
    demos: tyro.conf.Positional[Path],
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")],
    output: Annotated[Path, flag("-o")],
    seed: int = 0,
    passes: int = 20,
    physics: Annotated[str, offer(PRESETS)] = "paper",
) -> int:
    """Train the policy of the agent `bc` by behaviour cloning of recorded decisions, in a minute on one core.

    It learns to choose as the teacher did, from what an agent without privileges saw. Prints how often the two agree,
    also in every tenth episode, which is held out. `hazard-ms evaluate --agents bc:weights=FILE` scores it.

    Args:
        demos: A dataset of `hazard-ms demos record`, or a folder of datasets; those of the task are used.
        env_id: Task.
        output: Folder for bc_TASK.safetensors and bc_TASK.json.
        seed: Seed of all randomness.
        passes: Passes over all decisions.
        physics: Preset of the recorded hazards.

    Raises:
        ValueError: without recorded decisions of the task.
    """
    from hazard_ms.demonstrations.choices import choices
    from hazard_ms.learning.cloning import Student, imitate
    from hazard_ms.sketch.scenes import level_ranges, measures_of
    from hazard_ms.spec.checks import whole
    from hazard_ms.spec.storage.files import make_folder

    if measures_of(env_id, physics):
        raise ValueError(f"env_id must be a task without measures, since recordings have none, got {env_id}")
    student = Student(level_ranges(env_id, physics), whole(seed, 0, 2**31, "seed"))
    whole(passes, 1, 10**6, "passes")
    found = choices(demos, env_id, physics, student.encoder.layout)
    make_folder(output)
    command = f"train clone {shlex.quote(str(demos))} -e {env_id} --seed {seed} --passes {passes} --physics {physics}"
    return _stored(student, output, env_id, command, {"agreement": imitate(student, found, passes, print)})


def _stored(student: Student, output: Path, env_id: str, command: str, facts: dict[str, Any]) -> int:
    """Write the files of a `student`, whom a `command` made, and print the command that scores it; returns 0."""
    from hazard_ms.agents.learned.weights import ENDING, contents
    from hazard_ms.spec.storage.files import write_together

    path = output / f"bc_{env_id}{ENDING}"
    facts = {"command": f"hazard-ms {command}", "version": __version__, **facts}
    weights, told = contents(student.policy, env_id, facts)
    write_together({path: weights, path.with_suffix(".json"): told})
    print(f"hazard-ms evaluate -e {env_id} --split test --agents bc:weights={path} greedy")
    return 0


def ppo(
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")],
    output: Annotated[Path, flag("-o")],
    seed: int = 0,
    actions: Annotated[str, offer(ACTIONS)] = "options",
    decisions: int | None = None,
    minutes: float = 60.0,
    scenes: int = 225,
    reward: str | None = None,
    start: Path | None = None,
    masked: bool = False,
    share: float | None = None,
    physics: Annotated[str, offer(PRESETS)] = "paper",
    workers: int = 0,
) -> int:
    """Train the policy of the agent `rl`, or of `rl_paper`, by reinforcement learning in the sketch.

    It trains in generated scenes outside all splits, by sb3-contrib's MaskablePPO, and keeps the best in further ones.
    The same command resumes it; more --decisions or --minutes continue it. Score it with --agents rl:weights=FILE.

    Args:
        env_id: Task.
        output: Folder for rl_TASK.safetensors, .json, .csv (the curve) and .training; rl_paper_TASK with actions paper.
        seed: Seed of all randomness.
        actions: options, or paper: the six actions, the map, the network and the settings of the original's learner.
        decisions: Training decisions; by default 1,000,000 of options, 100,000 of the six actions.
        minutes: Wall time after which training ends, if not before [min].
        scenes: Number of training scenes.
        reward: value or paper; by default value for options, paper for the six actions.
        start: File NAME.safetensors of a policy to start from; by default an untrained one.
        masked: Choose only among the possible ones of the six actions.
        share: Layer width of the six actions' network, as a share of the original's; by default one half.
        physics: Preset of the hazards.
        workers: Processes that make scenes; 0: one per processor.

    Raises:
        ValueError: for numbers out of range, and without the extra `rl`.
    """
    from hazard_ms.agents.learned.weights import ENDING, load, load_map
    from hazard_ms.learning.scenes import generated
    from hazard_ms.sketch.scenes import SCENES, level_ranges, measures_of
    from hazard_ms.sketch.skill_times import load as times_of
    from hazard_ms.spec.checks import one_of, whole
    from hazard_ms.spec.storage.files import make_folder

    try:
        from hazard_ms.learning.checks import curve_of, ended
        from hazard_ms.learning.ppo import SHARE, Learner, shape_for
        from hazard_ms.learning.runs import Run
        from hazard_ms.learning.settings import BY_ACTIONS
    except ModuleNotFoundError as missing:
        raise ValueError(f"train ppo needs the extra `rl` ({missing}): pip install 'hazard_ms[rl]'") from None
    settings, six = BY_ACTIONS[one_of(actions, ACTIONS, "actions")], actions == "paper"
    wanted = settings.decisions if decisions is None else whole(decisions, 1, 2**31, "decisions")
    count, _ = whole(scenes, 1, VALIDATION - SCENES, "scenes"), whole(seed, 0, 2**31, "seed")
    reward = settings.reward if reward is None else one_of(reward, ("value", "paper"), "reward")
    if masked and not six:
        raise ValueError("--masked must be left out with --actions options, which are always masked")
    if share is not None and not six:
        raise ValueError(f"--share must be left out with --actions options, whose network has one width, got {share}")
    if not minutes > 0:
        raise ValueError(f"minutes must be positive, got {minutes}")
    width, processes = SHARE if share is None else share, whole(workers, 0, 1000, "workers")
    ranges, measures = level_ranges(env_id, physics), measures_of(env_id, physics)
    shape = shape_for(actions, ranges, width, masked, measures)
    begun = None if start is None else load_map(start, env_id) if six else load(start, env_id, measures=measures)
    if six and begun is not None and begun.shape != shape:
        raise ValueError(f"share and masked must be those of the --start policy, {begun.shape}, got {width}, {masked}")
    words = f"hazard-ms train ppo -e {env_id} --seed {seed} --scenes {scenes} --reward {reward} --physics {physics}"
    words += f"{f' --actions {actions} --share {width:g}' if six else ''}{' --masked' if masked else ''}"
    command = words if start is None else f"{words} --start {shlex.quote(str(start.resolve()))}"
    make_folder(output)
    name = "rl_paper" if six else "rl"
    facts = {"command": command, "version": __version__, "physics": physics, "validation": VALIDATION}
    run = Run(output / f"{name}_{env_id}{ENDING}", env_id, facts)
    state = run.state()
    if state is not None and ended(curve_of(state), settings, wanted, minutes):
        print(f"{run.path} has already trained for that long, or no longer improves")
        return 0
    numbers = [*range(SCENES, SCENES + count), *range(VALIDATION, VALIDATION + VALIDATION_SCENES)]
    made = generated(env_id, physics, numbers, processes)
    learner = Learner(made[:count], made[count:], ranges, times_of("fetch"), seed, reward, begun, settings, shape)
    if state is not None:
        learner.resume(state)
    run.train(learner, wanted, minutes)
    print(f"hazard-ms evaluate -e {env_id} --agents {name}:weights={run.path} greedy --split train")
    return 0


def score(
    weights: tyro.conf.Positional[Path],
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")],
    physics: Annotated[str, offer(PRESETS)] = "paper",
) -> int:
    """Print the mean Value of a policy and of plain rules in the sketch, in scenes that no policy is trained in.

    Args:
        weights: File NAME.safetensors of the policy.
        env_id: Task of the policy.
        physics: Preset of the hazards.
    """
    from hazard_ms.agents.learned.map_policy import MapPolicy
    from hazard_ms.agents.learned.weights import load, load_map, sees_map
    from hazard_ms.learning.comparison import six_table, table
    from hazard_ms.learning.playing import MapPlayer, Player
    from hazard_ms.sketch.scenes import measures_of, more_scenes
    from hazard_ms.sketch.skill_times import load as times_of

    six, measures = sees_map(weights), measures_of(env_id, physics)
    policy = load_map(weights, env_id) if six else load(weights, env_id, measures=measures)
    scenes, times = more_scenes(env_id, physics, VALIDATION, VALIDATION_SCENES), times_of("fetch")
    if isinstance(policy, MapPolicy):
        print(six_table(scenes, times, {str(weights): MapPlayer(policy).play}))
    else:
        print(table(scenes, times, {str(weights): Player(policy).play}))
    return 0


TrainCommand = (
    Annotated[int, tyro.conf.subcommand(name="bc", constructor=bc)]
    | Annotated[int, tyro.conf.subcommand(name="clone", constructor=clone)]
    | Annotated[int, tyro.conf.subcommand(name="ppo", constructor=ppo)]
    | Annotated[int, tyro.conf.subcommand(name="score", constructor=score)]
)
