"""The commands `hazard-ms llm ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import flag

LONGEST = 3600.0  # that an answer may take in a check [s] [ours]
LAST_PORT = 65535  # of TCP


def serve_scripted(port: int = 0) -> int:
    """Serve models that answer by a script on this machine, without a network; Ctrl-C ends it.

    Prints its address, then the name of each model and what it does.

    Args:
        port: Port of 127.0.0.1; 0: any free one.

    Raises:
        ValueError: for a port that is taken.
    """
    from hazard_ms.agents.llm.scripted import BEHAVIOURS, ScriptedServer
    from hazard_ms.spec.checks import whole

    whole(port, 0, LAST_PORT, "port")
    try:
        server = ScriptedServer(port)
    except OSError as error:
        raise ValueError(f"port must be free, got {port}: {error.strerror}") from None
    print(f"address: {server.address}", flush=True)
    for name, meaning in BEHAVIOURS.items():
        print(f"  {name:16} {meaning}", flush=True)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        print("stopped")
    finally:
        server.stopping.set()
        server.server_close()
    return 0


def check(
    base_url: str = "",
    model: str = "",
    price_in: float = 0.0,
    price_out: float = 0.0,
    deadline: float = 50.0,
    limit_field: str = "max_tokens",
    extra: str = "",
) -> int:
    """Ask a model a few small questions in each way of answering; say whether it can play, how fast, and at what cost.

    Exits with 1 if its answers cannot be read in any way. The key comes from HAZARD_MS_LLM_KEY.

    Args:
        base_url: Address of the server, such as http://127.0.0.1:8000/v1; by default HAZARD_MS_LLM_BASE_URL.
        model: Name of the model there; by default HAZARD_MS_LLM_MODEL.
        price_in: Price of a million tokens read [USD].
        price_out: Price of a million tokens written [USD].
        deadline: Time for an answer [s].
        limit_field: Field of a request that limits the length of an answer.
        extra: More fields of a request, name:value;name:value or a JSON object, such as reasoning_effort:none.

    Raises:
        ValueError: for an address that cannot be used.
    """
    from hazard_ms.agents.llm.check import report, ways

    if not 0.0 < deadline <= LONGEST:
        raise ValueError(f"deadline must be more than 0 and at most {LONGEST:g} s, got {deadline}")
    found = list(ways(base_url, model, deadline, limit_field, extra))
    told = report(found, price_in, price_out)
    print(told)
    return int("It can play" not in told)


def page(
    trace: tyro.conf.Positional[Path],
    result: Path | None = None,
    output: Annotated[Path, flag("-o")] = Path("decisions.html"),
    pictures: bool = False,
    load: tuple[str, ...] = (),
) -> int:
    """Write a page with everything that a model was asked in an episode, what it answered, and what was done.

    Args:
        trace: File that the agent llm:trace=FOLDER wrote.
        result: Result of the same episode; what `hazard-ms regret` wrote beside it is shown, too.
        output: Page to write, NAME.html.
        pictures: Play the result again, for a picture of the head camera and a map at each decision.
        load: Modules, or files NAME.py, that register what the episode needs for pictures.

    Raises:
        ValueError: for files that are not a trace and a result, and for pictures without a result.
    """
    from hazard_ms.evaluation.regret.causes import beside
    from hazard_ms.evaluation.regret.decision_page import decision_page, read_trace
    from hazard_ms.evaluation.result import EpisodeResult
    from hazard_ms.spec.storage.files import make_folder, write

    if output.suffix != ".html":
        raise ValueError(f"output must end in .html, got {output.name!r}")
    if pictures and result is None:
        raise ValueError("--pictures needs --result, since it plays the result again")
    rows = read_trace(trace)
    read = None if result is None else EpisodeResult.read(result)
    judged = None if result is None else beside(result)
    make_folder(output.parent)
    views: dict[int, tuple[str, str]] = {}
    if pictures and read is not None:
        from hazard_ms.pictures.decision_pictures import decision_pictures

        views = decision_pictures(read, {row["frame"] for row in rows}, load)
        print(f"pictures: {sum(row['frame'] in views for row in rows)} of {len(rows)} decisions")
    write(output, decision_page(rows, trace.stem, read, judged, views))
    print(f"page: {output.resolve()}")
    return 0


LlmCommand = (
    Annotated[int, tyro.conf.subcommand(name="serve-scripted", constructor=serve_scripted)]
    | Annotated[int, tyro.conf.subcommand(name="check", constructor=check)]
    | Annotated[int, tyro.conf.subcommand(name="page", constructor=page)]
)
