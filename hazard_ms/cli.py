"""The command `hazard-ms`. Each sub-command imports what it needs when it is called, so that `hazard-ms --help` is quick."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Annotated, Any

import tyro

from hazard_ms.asset_commands import AssetCommand
from hazard_ms.evaluating_order import Evaluation
from hazard_ms.order import Order
from hazard_ms.pictures.commands import gallery, render
from hazard_ms.scene_commands import SceneCommand
from hazard_ms.validation.command import validate


def doctor(json: bool = False, draw: bool = True) -> int:
    """Find out why hazard_ms does not start or draw here; name one cause and one command. Ends with 1 if something is at fault.

    Args:
        json: Print everything as JSON.
        draw: Draw a picture (seconds) instead of only starting the renderer.
    """
    from hazard_ms.doctor import collect, report

    return report(collect(draw=draw), as_json=json)


def version() -> int:
    """Print the versions of hazard_ms and of what results depend on."""
    import platform

    from hazard_ms import __version__
    from hazard_ms.doctor import installed

    print(f"hazard_ms {__version__}")
    print(f"python {platform.python_version()}")
    for name, number in sorted(installed().items()):
        print(f"{name} {number}")
    return 0


def bench(
    env_id: Annotated[str, tyro.conf.arg(aliases=["-e"])] = "HazardFire-v1",
    frames: int = 600,
    seed: Annotated[int, tyro.conf.arg(aliases=["-s"])] = 0,
    episode: bool = True,
    looks: bool = False,
    kernels: bool = False,
) -> int:
    """Print where the time of a frame goes, phase by phase, and how long a greedy episode takes, with versions and machine.

    Args:
        env_id: Task.
        frames: Frames to average over.
        seed: Seed of the episode.
        episode: Also play a whole greedy episode.
        looks: Only print what the effects of each mode cost in a picture.
        kernels: Only print what the kernels of flood and wind cost for 1,024 environments of 64 bodies on one thread.
    """
    if kernels:
        from hazard_ms.bench_kernels import report as report_kernels

        print(report_kernels())
        return 0
    if looks:
        from hazard_ms.bench_looks import report as report_looks

        print(report_looks(env_id, max(frames // 10, 3), seed))
        return 0
    from hazard_ms.bench import report

    print(report(env_id, frames, seed, episode))
    return 0


def scenes(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[SceneCommand]]) -> int:
    """Scenes: list, make, show, check, import."""
    return int(done)


def assets(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[AssetCommand]]) -> int:
    """Models: add your own, list, remove, draw them all."""
    return int(done)


def play(order: tyro.conf.OmitArgPrefixes[Order]) -> int:
    """Play one episode of one agent; with --video, write its film, its result as JSON and its page."""
    from hazard_ms.play import main as play_order

    return play_order(order)


def evaluate(evaluation: tyro.conf.OmitArgPrefixes[Evaluation]) -> int:
    """Play agents on the scenes of a split; print the scores with 95 % intervals. Goes on where a broken run stopped."""
    from hazard_ms.evaluating import evaluate as run

    return run(evaluation)


COMMANDS: dict[str, Callable[..., Any]] = {
    "doctor": doctor,
    "version": version,
    "play": play,
    "render": render,
    "gallery": gallery,
    "evaluate": evaluate,
    "bench": bench,
    "validate": validate,
    "scenes": scenes,
    "assets": assets,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one sub-command and return its exit code."""
    try:
        return int(tyro.extras.subcommand_cli_from_dict(COMMANDS, prog="hazard-ms", description=__doc__, args=arguments) or 0)
    except ValueError as error:  # input that is not allowed: say so, without a trace of where it was noticed
        print(f"hazard-ms: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
