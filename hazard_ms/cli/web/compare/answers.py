"""The addresses below /api/compare, and the page of each episode.

Addresses name folders and results by keys, never by paths, so that none can lead out of the folders.
"""

from __future__ import annotations

import json
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from hazard_ms.cli.web.compare.numbers import contents, numbers, overview
from hazard_ms.cli.web.compare.shelf import Book, Librarian, Shelf, film_of
from hazard_ms.cli.web.compare.timelines import timelines
from hazard_ms.cli.web.files import address
from hazard_ms.cli.web.guard import FILES
from hazard_ms.evaluation.page import page

MOST_KEPT = 8  # groups whose numbers are remembered [ours]


class Plain(JSONResponse):
    """JSON in ASCII, which can hold names that are not valid Unicode."""

    def render(self, content: Any) -> bytes:
        """The content as bytes. Raises ValueError for numbers that are not finite."""
        return json.dumps(content, allow_nan=False, separators=(",", ":")).encode("ascii")


class Counted:
    """The numbers of the last groups that were asked for, worked out again when a file of theirs changes."""

    def __init__(self) -> None:
        self._made: OrderedDict[tuple[Any, ...], dict[str, Any]] = OrderedDict()
        self._lock = threading.Lock()

    def numbers(self, settings: str, books: Sequence[Book]) -> dict[str, Any]:
        """The numbers of the group with these settings. Raises ValueError where nothing has them."""
        films = tuple(film_of(book.kept) is not None for book in books)
        key = (settings, tuple((book.key, book.stamp) for book in books), films)
        with self._lock:  # a page that asks twice waits instead of counting twice
            if key not in self._made:
                self._made[key] = numbers(settings, books)
            self._made.move_to_end(key)
            while len(self._made) > MOST_KEPT:
                self._made.popitem(last=False)
            return self._made[key]


def routes(folders: Sequence[Path]) -> list[Route]:
    """The routes of the comparison of the results in `folders`.

    /api/compare/folders                              all folders, and the files that cannot be shown
    /api/compare/groups?folder=KEY&...                the settings of the results in some folders, or in all
    /api/compare/numbers?settings=TEXT&folder=KEY&... scores, curves and episodes with these settings
    /api/compare/episodes?key=KEY&...                 the timelines of some results
    /files/episode/KEY                                the page of one
    """
    librarian, counted = Librarian(folders), Counted()

    def of_chosen(request: Request) -> list[Book]:
        return librarian.look().chosen(request.query_params.getlist("folder"))

    def counted_of(request: Request) -> Any:
        return counted.numbers(request.query_params.get("settings", ""), of_chosen(request))

    def episodes(request: Request) -> Any:
        found = librarian.look().books
        keys = request.query_params.getlist("key")
        return {"episodes": [made | _links(folders, found[made["key"]]) for made in timelines(found, keys)]}

    def episode_page(request: Request) -> Response:
        return _page(folders, librarian.look(), str(request.path_params["key"]))

    return [
        Route("/api/compare/folders", _told(lambda request: overview(librarian.look()))),
        Route("/api/compare/groups", _told(lambda request: {"groups": contents(of_chosen(request))})),
        Route("/api/compare/numbers", _told(counted_of)),
        Route("/api/compare/episodes", _told(episodes)),
        Route(FILES + "episode/{key:str}", episode_page),
    ]


def _told(what: Callable[[Request], Any]) -> Callable[[Request], Response]:
    """A route that answers with JSON, in a thread of its own."""

    def answer(request: Request) -> Response:
        return Plain(what(request))

    return answer


def _links(folders: Sequence[Path], book: Book) -> dict[str, str | None]:
    """The addresses of an episode's page and film; None for a film that is not there."""
    film = film_of(book.kept)
    return {
        "page_link": f"{FILES}episode/{book.key}",
        "film_link": None if film is None else address(folders, film),
    }


def _page(folders: Sequence[Path], shelf: Shelf, key: str) -> Response:
    if key not in shelf.books:
        raise HTTPException(404, "there is no such episode")
    book = shelf.books[key]
    film = _links(folders, book)["film_link"]
    made = page(book.kept.result, film and f"../{film.removeprefix(FILES)}")  # relative: the key of files stays in it
    return HTMLResponse(made.encode("utf-8", "replace"))
