"""The command `hazard-ms`.

`hazard-ms --version` prints the version. Each sub-command imports what it needs when it is called, so that help is
quick.
"""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

import tyro

from hazard_ms.cli.assets import AssetCommand
from hazard_ms.cli.bench import bench, danger
from hazard_ms.cli.demos import DemosCommand
from hazard_ms.cli.describe import describe
from hazard_ms.cli.episodes import evaluate, play, replay, serve
from hazard_ms.cli.llm import LlmCommand
from hazard_ms.cli.perception import PerceptionCommand
from hazard_ms.cli.pictures import gallery, render
from hazard_ms.cli.report import commitments, leaderboard, regret, report, submit, verify
from hazard_ms.cli.scenes import SceneCommand
from hazard_ms.cli.sketch import SketchCommand
from hazard_ms.cli.train import TrainCommand
from hazard_ms.cli.validate import validate
from hazard_ms.spec.foreign.terminal import plain, plain_output
from hazard_ms.spec.registry.version import __version__

DESCRIPTION = "Rescue tasks in fire, flood and wind. `hazard-ms COMMAND --help` describes a command."
HELP = {"-h", "--help"}  # what is then printed is our own text, in colours


def doctor(json: bool = False, draw: bool = True) -> int:
    """Find out why hazard_ms does not start or render here; print one cause and the command that fixes it.

    Exits with 1 if something is wrong.

    Args:
        json: Print everything as JSON.
        draw: Draw a picture, which takes seconds, instead of only starting the renderer.
    """
    from hazard_ms.machine.doctor import collect, report

    return report(collect(draw=draw), as_json=json)


def version() -> int:
    """Print the versions of hazard_ms and of the packages that results depend on."""
    import platform

    from hazard_ms.machine.doctor import installed

    print(f"hazard_ms {__version__}")
    print(f"python {platform.python_version()}")
    for name, number in sorted(installed().items()):
        print(f"{name} {number}")
    return 0


def scenes(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[SceneCommand]]) -> int:
    """Scenes: list, make, show, check and import them; see what robots can reach."""
    return int(done)


def assets(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[AssetCommand]]) -> int:
    """Models: add your own, list, remove and render them."""
    return int(done)


def sketch(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[SketchCommand]]) -> int:
    """Rescues without a simulator: fit skill times, check against real episodes, measure speed."""
    return int(done)


def demos(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[DemosCommand]]) -> int:
    """Demonstrations: record, verify, repair, merge, stats, show, export."""
    return int(done)


def llm(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[LlmCommand]]) -> int:
    """Language models: check whether one can play, show its decisions, serve scripted models for tests."""
    return int(done)


def perception(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[PerceptionCommand]]) -> int:
    """Labelled pictures of hazards for computer vision: capture, check, show, score a detector."""
    return int(done)


def train(done: tyro.conf.OmitArgPrefixes[tyro.conf.OmitSubcommandPrefixes[TrainCommand]]) -> int:
    """Policies: train by cloning or reinforcement learning, and score in the sketch."""
    return int(done)


COMMANDS: dict[str, Callable[..., Any]] = {
    "doctor": doctor,
    "version": version,
    "play": play,
    "render": render,
    "gallery": gallery,
    "evaluate": evaluate,
    "replay": replay,
    "serve": serve,
    "regret": regret,
    "report": report,
    "submit": submit,
    "verify": verify,
    "leaderboard": leaderboard,
    "commitments": commitments,
    "describe": describe,
    "bench": bench,
    "danger": danger,
    "validate": validate,
    "scenes": scenes,
    "assets": assets,
    "sketch": sketch,
    "demos": demos,
    "llm": llm,
    "perception": perception,
    "train": train,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one sub-command. Returns its exit code: 2 for input that is not valid, which a line on stderr describes."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # frames of help texts where the locale knows ASCII only
    try:
        with contextlib.nullcontext() if HELP & set(words) else plain_output():
            code = _run(words)
        if sys.stdout is not None:  # it may be closed
            sys.stdout.flush()
    except BrokenPipeError:  # whoever reads the output has read enough, as `head` does
        _silence()
        return 0
    except OSError as error:
        if error.errno != errno.ENOSPC or error.filename is not None:
            raise
        print(f"hazard-ms: the output must be written whole, got {error.strerror}; free some space", file=sys.stderr)
        _silence()
        return 1
    return code


def _silence() -> None:
    """Let nothing more reach the standard output, which cannot take it."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(words: list[str]) -> int:
    if words == ["--version"]:
        print(f"hazard_ms {__version__}")
        return 0
    try:
        done = tyro.extras.subcommand_cli_from_dict(COMMANDS, prog="hazard-ms", description=DESCRIPTION, args=words)
    except ValueError as error:  # its text says everything: no traceback
        print("hazard-ms:", plain(str(error)), file=sys.stderr)
        return 2
    return int(done or 0)


if __name__ == "__main__":
    sys.exit(main())
