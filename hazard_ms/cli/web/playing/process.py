"""The process of one rescue: it owns the environment, and talks to the server over a pipe."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from urllib.parse import quote

from hazard_ms.cli.web.playing.link import Link
from hazard_ms.cli.web.rescue import ALL, PLAY, Rescue, journal, keep
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.machine.processes import end_with_parent

POLITE = 5  # niceness of making a film: rescues that are being played come first [ours]


def main(connection: Connection, rescue: Rescue, folder: Path) -> None:
    """Play the rescue, and keep it in `folder`; whatever goes wrong is told to the page."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends its workers
    link = Link(connection)
    try:
        play(link, rescue, folder)
    except (EOFError, BrokenPipeError, ConnectionResetError):  # the server has gone; the journal stays
        return
    except Exception as error:
        from hazard_ms.evaluation.attempts import told

        link.say("failed", why=told(error))


def play(link: Link, rescue: Rescue, folder: Path) -> None:
    """Play the rescue to its end, and keep it in `folder`. Raises ValueError for one that cannot be played.

    Its journal stays until all is kept, so that a process that dies meanwhile costs nothing: the next one goes on.
    """
    from hazard_ms.cli.web.playing import saving

    link.say("building")
    import torch

    torch.set_num_threads(1)
    rescue.check()
    found = saving.kept(folder, rescue.name) if rescue.over else None
    if found is not None:
        _tell_again(link, rescue, found[1])
    else:
        result = _play(link, rescue, folder)
        if result is None:
            link.say("closed")
            return
        found = saving.place(folder, result, rescue.name), result
        saving.keep(*found)
    _finish(link, rescue, folder, *found)


def _play(link: Link, rescue: Rescue, folder: Path) -> EpisodeResult | None:
    """Play the rescue. Returns its result, None if the page has ended it."""
    from hazard_ms.cli.web.playing.desk import Desk, EndedError
    from hazard_ms.cli.web.playing.pictures import SIZE
    from hazard_ms.cli.web.playing.player import Player
    from hazard_ms.evaluation.averted.account import Account
    from hazard_ms.evaluation.runner import Runner, environment, fates, result_of

    start, options = time.perf_counter(), rescue.episode
    desk = Desk(link, rescue, folder)
    camera = {"width": SIZE[0], "height": SIZE[1]}
    env = environment(options, render_mode="rgb_array", human_render_camera_configs=camera)
    account = Account() if env.base.task.averted else None
    try:
        watchers = [desk] if account is None else [desk, account]
        played = Runner(env, Player(rescue, desk), watchers).run(options.seed, options.reset_options)
        keep(folder, replace(desk.so_far(), over=True))
        desk.tell_rows(played)
        desk.tell("over", ended=played.ended)
        desk.show(everything=True)
        result = result_of(options, env, played)
        if account is not None:
            result = replace(result, **account.closed(lambda: fates(env)))
        return replace(result, wall_seconds=time.perf_counter() - start)
    except EndedError:
        return None
    finally:
        env.close()


def _tell_again(link: Link, rescue: Rescue, result: EpisodeResult) -> None:
    """Tell the page of a rescue that ended in an earlier process, which did not come to make its film."""
    from hazard_ms.cli.web.playing.desk import tell_row

    link.say(
        "begun",
        scene=result.scene,
        text="",
        frame_seconds=0.0,
        max_frames=result.max_frames,
        agent=result.agent,
        task=result.env_id,
        seed=result.seed,
        room=rescue.view == ALL,
        drawn=False,
    )
    link.say("tick", frame=result.frames, value=result.tally.value, held=None)
    for number, record in enumerate(result.decisions):
        tell_row(link, number, record)


def _finish(link: Link, rescue: Rescue, folder: Path, path: Path, result: EpisodeResult) -> None:
    """Make the film of a rescue whose result is in the file `path`, and delete its journal."""
    from hazard_ms.cli.web.playing import saving
    from hazard_ms.evaluation.report import summary

    went = summary(result, rescue.episode.goal)
    link.say("over", ended=result.ended, summary=went, files=_links(path, (".html", ".json")))
    os.nice(POLITE)
    if result.lost is not None and result.lost_alone is None:
        result = replace(result, lost_alone=saving.lost_alone(rescue.episode))
        saving.keep(path, result)
    if result.averted is not None:
        link.say("averted", share=result.averted)
    told = lambda frame: link.say("filming", frame=frame, of=result.frames)  # noqa: E731
    verdict, demonstration = saving.film(path, rescue.episode, result, told, teaches=rescue.kind == PLAY)
    journal(folder, rescue.name).unlink(missing_ok=True)
    where = None if demonstration is None else str(demonstration)
    link.say("kept", replay=verdict, demonstration=where, files=_links(path, (".html", ".mp4", ".json")))


def _links(path: Path, suffixes: tuple[str, ...]) -> list[dict[str, str]]:
    """Names and addresses of the files of a rescue."""
    names = [path.with_suffix(suffix).name for suffix in suffixes]
    return [{"name": name, "address": f"/files/0/{quote(name)}"} for name in names]
