"""The commands on folders of results, `hazard-ms report` and so on; they import what they need when called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import BACKENDS, flag, offer

# as evaluation.submissions.tracks has them
TRACKS = ("published", "perception", "clock", "houses", "teams", "trial", "trial-teams")
Hidden = tuple[Path, Path] | None
Backend = Annotated[str, offer(BACKENDS)]


def report(
    folders: Annotated[tuple[Path, ...], tyro.conf.Positional],
    output: Annotated[Path, flag("-o")] = Path("report.html"),
    json: bool = False,
    pages: bool = True,
    csv: Path | None = None,
) -> int:
    """Compare agents over folders of results: scores, differences, regret, and where frames and targets go.

    Prints the scores with 95 % intervals, and writes one page with tables, charts and links to each episode.

    Args:
        folders: Folders from `hazard-ms evaluate`, read with their subfolders.
        output: Page to write, NAME.html.
        json: Print everything as JSON instead, and write no page.
        pages: Write the page of each episode, into a folder NAME_episodes beside the page.
        csv: File for one row of numbers for each episode, NAME.csv.

    Raises:
        ValueError: for folders without results, and for results that cannot be compared.
    """
    from json import dumps

    from hazard_ms.evaluation.comparison.folders import groups
    from hazard_ms.evaluation.comparison.page import episode_pages, page
    from hazard_ms.evaluation.comparison.rows import table as table_of_rows
    from hazard_ms.evaluation.comparison.summary import summary, table
    from hazard_ms.spec.storage.files import make_folder, write

    if not folders:
        raise ValueError("folders must be at least one that `hazard-ms evaluate -o FOLDER` wrote, got none")
    if output.suffix != ".html":
        raise ValueError(f"output must end in .html, got {output.name!r}")
    found, left_out = groups(folders)
    summaries = [summary(group) for group in found]
    if csv is not None:
        make_folder(csv.parent)
        write(csv, table_of_rows(found))
    if json:
        print(dumps({"groups": summaries, "left_out": left_out}, indent=1, allow_nan=False))
        return 0
    print("\n\n".join(map(table, summaries)))
    for line in left_out:
        print(f"left out: {line}")
    make_folder(output.parent)
    write(output, page(found, summaries, episode_pages(found, output) if pages else {}, output, left_out))
    print(f"page: {output.resolve()}")
    return 0


def regret(
    folders: Annotated[tuple[Path, ...], tyro.conf.Positional],
    output: Annotated[Path | None, flag("-o")] = None,
    workers: int = 0,
    backend: Backend = "local",
    address: str | None = None,
    load: tuple[str, ...] = (),
) -> int:
    """Judge each decision of recorded episodes: how much value it gave away, and why.

    Simulates the episodes again, and writes NAME.regret.json beside each result NAME.json; existing files that fit
    their result are kept. Prints what each agent lost, and why. `hazard-ms report` shows it too.

    Args:
        folders: Folders from `hazard-ms evaluate`, read with their subfolders.
        output: File for what each agent lost, NAME.json.
        workers: Processes; 0: one per core.
        backend: Where episodes are simulated: in this process (serial), in local processes, or on a ray cluster.
        address: Address of the ray cluster, such as auto; by default only this machine.
        load: Modules, or files NAME.py, that register what the episodes need.
    """
    from json import dumps

    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.regret.command import regret as run
    from hazard_ms.evaluation.regret.table import shares
    from hazard_ms.evaluation.spread import Where
    from hazard_ms.spec.storage.files import write

    user_path()
    found = run(folders, Where(workers, backend, address), load)
    if output is not None:
        agents = dict.fromkeys(one.agent for one in found)
        made = {agent: shares([one for one in found if one.agent == agent]) for agent in agents}
        write(output, dumps(made, indent=1, allow_nan=False) + "\n")
    return 0


def submit(
    folders: Annotated[tuple[Path, ...], tyro.conf.Positional],
    output: Annotated[Path, flag("-o")] = Path("submission.zip"),
    track: Annotated[str, offer(TRACKS)] = "published",
    agent: str | None = None,
    card: Path = Path("card.json"),
    hidden: Hidden = None,
) -> int:
    """Pack the episodes of one agent into a file for the leaderboard: decisions, hashes, versions, card, no code.

    Args:
        folders: Folders from `hazard-ms evaluate`, read with their subfolders.
        output: Submission to write, NAME.zip.
        track: Track of the leaderboard.
        agent: Name of the agent in the results; needed only if they hold several.
        card: File with the agent's card, which docs/leaderboard.md describes.
        hidden: Commitments and published scenes of a hidden set, for its track.

    Raises:
        ValueError: if an episode of the track is missing, or has a fault that `hazard-ms verify` would find.
    """
    from hazard_ms.evaluation.submissions.card import read_card
    from hazard_ms.evaluation.submissions.commitments import read_hidden
    from hazard_ms.evaluation.submissions.faults import faults_of
    from hazard_ms.evaluation.submissions.packing import pack, results_of, submission_of
    from hazard_ms.evaluation.submissions.tracks import track_of
    from hazard_ms.spec.storage.files import make_folder, write

    published = read_hidden(hidden)
    wanted = published or track_of(track)
    own = read_card(card)
    content = pack(results_of(folders, wanted, agent), wanted, own)
    if faults := faults_of(submission_of(content, output.name), wanted):
        raise ValueError(f"a submission must have no faults, got {len(faults)}, the first: {faults[0]}")
    make_folder(output.parent)
    write(output, content)
    print(f"submission: {output.resolve()}, {len(wanted.places)} episodes, {len(content)} bytes")
    return 0


def verify(
    file: Annotated[Path, tyro.conf.Positional],
    output: Annotated[Path | None, flag("-o")] = None,
    episodes: int = 0,
    seed: int = 0,
    workers: int = 0,
    backend: Backend = "local",
    address: str | None = None,
    key: Path | None = None,
    known: Path | None = None,
    hidden: Hidden = None,
) -> int:
    """Simulate the episodes of a submission again, compare everything, and write a report.

    Exits with 1 if anything is wrong; docs/leaderboard.md explains each fault by name.

    Args:
        file: Submission, NAME.zip.
        output: Report to write, NAME.report.json.
        episodes: Number of episodes drawn for a quick look; 0: all, as the leaderboard requires.
        seed: Seed for drawing them.
        workers: Processes; 0: one per core.
        backend: Where episodes are simulated: in this process (serial), in local processes, or on a ray cluster.
        address: Address of the ray cluster, such as auto; by default only this machine.
        key: OpenSSH key to sign the report with; the signature is written beside it.
        known: Folder of reports on earlier submissions, to find copied decisions.
        hidden: Commitments and published scenes of a hidden set.
    """
    from hazard_ms.evaluation.spread import Where
    from hazard_ms.evaluation.submissions.verifying import verify as run

    return run(file, output, episodes, seed, Where(workers, backend, address), key, known, hidden)


def leaderboard(
    folder: Annotated[Path, tyro.conf.Positional], output: Annotated[Path, flag("-o")] = Path("leaderboard")
) -> int:
    """Write the leaderboard as a static site, from signed reports of whole submissions only.

    Args:
        folder: Folder with reports NAME.report.json, their signatures, the file `signers`, and films in NAME.
        output: Folder for the site; index.html is its first page.
    """
    from hazard_ms.evaluation.submissions.site import write_site
    from hazard_ms.evaluation.submissions.standings import standings

    tracks, left_out = standings(folder)
    first = write_site(tracks, left_out, output)
    for name, rows in tracks.items():
        print(f"{name}: {', '.join(row.title for row in rows)}")
    for line in left_out:
        print(f"not counted: {line}")
    print(f"page: {first.resolve()}")
    return 0


def commitments(
    file: Annotated[Path, tyro.conf.Positional],
    published: Path | None = None,
    output: Annotated[Path | None, flag("-o")] = None,
    draw: int = 0,
    secret: Path | None = None,
) -> int:
    """Check published hidden scenes against their commitments; with --draw, draw a new set.

    Args:
        file: Commitments: the hashes of a set.
        published: Published scenes; each must match its commitment.
        output: Folder for the published scenes, as `hazard-ms evaluate --scenes` plays them.
        draw: Number of scenes to draw for each task; the commitments go into the file, which names the set.
        secret: File for the drawn scenes; keep it secret until you publish it.

    Raises:
        ValueError: that names the first scene that was not committed, and for options that do not go together.
    """
    from hazard_ms.evaluation.submissions.commitments import read_hidden, write_drawn, write_scenes

    if (published is None) == (draw == 0) or (draw != 0) != (secret is not None):
        raise ValueError("either --published must be given, or both --draw and --secret, got another combination")
    if published is None:
        assert secret is not None
        write_drawn(file, secret, file.stem, draw)
        print(f"commitments: {file.resolve()}\nkeep secret until you publish it: {secret.resolve()}")
        return 0
    track = read_hidden((file, published))
    assert track is not None
    if output is not None:
        write_scenes(track, output)
    print(f"all {len(track.places)} scenes of {track.name} match their commitments")
    return 0
