"""The files in folders of results: films, pages, results. Nothing outside of the folders, and nothing hidden."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from hazard_ms.cli.web.guard import FILES

KINDS = {".json": "application/json", ".html": "text/html", ".mp4": "video/mp4", ".jpg": "image/jpeg"}


def file_routes(folders: Sequence[Path]) -> list[Route]:
    """The route of the files in `folders`: /files/NUMBER/PATH."""

    async def file(request: Request) -> Response:
        path = inside(folders, int(request.path_params["number"]), str(request.path_params["path"]))
        if path is None:
            raise HTTPException(404, "there is no such file")
        return FileResponse(path, media_type=KINDS[path.suffix])

    return [Route(FILES + "{number:int}/{path:path}", file)]


def inside(folders: Sequence[Path], number: int, path: str) -> Path | None:
    """The file that an address means; None where the folder has no such file, or it may not be shown."""
    if not 0 <= number < len(folders) or any(part.startswith(".") for part in path.split("/")) or "\0" in path:
        return None
    try:
        root = folders[number].resolve()
        found = (root / path).resolve()
        shown = found.is_relative_to(root) and found.suffix in KINDS and found.is_file()
    except (OSError, RuntimeError, UnicodeError):  # a name that is too long, links in a circle
        return None
    return found if shown else None


def address(folders: Sequence[Path], path: Path) -> str:
    """The address at which a file of `folders` is served. Raises ValueError for one that lies in none of them."""
    for number, folder in enumerate(folders):
        if path.resolve().is_relative_to(folder.resolve()):
            return f"{FILES}{number}/{quote(str(path.resolve().relative_to(folder.resolve())))}"
    raise ValueError(f"path must be in one of the folders of results, got {path}")
