"""The tables of a LeRobot dataset: rows, episodes, tasks and statistics."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations.export.lerobot_language import COLUMN
from hazard_ms.demonstrations.export.lerobot_stats import Stats

VERSION = "v3.0"
MB = 2**20  # bytes, as LeRobot counts them
TABLE_SIZE = 100  # of a file of rows before it is compressed, at most [MB], as LeRobot's default
FILM_SIZE = 200  # of a film of many episodes, at most [MB], as LeRobot's default
CHUNK = 1000  # number of files in a folder, at most, as LeRobot's default
BLOCK = 64  # width of what is read at once of a column [numbers of a row] [ours]
INDEX = "__index_level_0__"  # column that pandas takes for the index of a table


def place(number: int, suffix: str) -> str:
    """Path of the file with this number within the folder of its kind."""
    chunk, file = divmod(number, CHUNK)
    return f"chunk-{chunk:03d}/file-{file:03d}.{suffix}"


class Tables:
    """Appends the rows of episodes to the files of a dataset; `close` finishes the last one."""

    def __init__(self, folder: Path) -> None:
        """Begin the rows of the dataset `folder`."""
        self._folder = folder / "data"
        self._number = -1  # of the file that is being written
        self._writer: Any = None
        self._size = 0  # bytes in it

    def add(self, columns: dict[str, NDArray[Any]], **others: Any) -> dict[str, Any]:
        """Append the rows of an episode, [R, ...] in each column; `others` are pyarrow's own.

        Returns the columns that say where they are.
        """
        import pyarrow as pa
        import pyarrow.parquet as pq

        table = pa.table({**{name: _arrow(column) for name, column in columns.items()}, **others})
        if self._writer is None or self._size + table.nbytes > TABLE_SIZE * MB:
            self.close()
            self._number += 1
            path = self._folder / place(self._number, "parquet")
            path.parent.mkdir(parents=True, exist_ok=True)
            self._writer, self._size = pq.ParquetWriter(path, table.schema), 0
        self._writer.write_table(table)
        self._size += table.nbytes
        chunk, number = divmod(self._number, CHUNK)
        return {"data/chunk_index": chunk, "data/file_index": number}

    def close(self) -> None:
        """Finish the file that is being written."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None


def read_columns(folder: Path) -> Iterator[tuple[str, NDArray[Any]]]:
    """The columns of numbers of all rows of the finished dataset `folder`, [R, D], one by one, BLOCK wide at most.

    A wider one comes in several parts under the same name, so that they need not be in memory at once.
    """
    import pyarrow.parquet as pq

    files = [pq.ParquetFile(path) for path in sorted((folder / "data").rglob("*.parquet"))]
    for field in files[0].schema_arrow:
        if field.name == COLUMN:  # words
            continue
        width = getattr(field.type, "list_size", 1)
        for start in range(0, width, BLOCK):
            yield field.name, np.concatenate([_part(file, field.name, width, start) for file in files])


def _part(file: Any, name: str, width: int, start: int) -> NDArray[Any]:
    """BLOCK numbers of each row of a column that is `width` wide, from `start` on."""
    column = file.read(columns=[name])[name].combine_chunks()
    flat = column.flatten() if width > 1 else column
    return np.array(flat.to_numpy(zero_copy_only=False).reshape(len(column), -1)[:, start : start + BLOCK])


def _arrow(column: NDArray[Any]) -> Any:
    """A column [R] or [R, D] as pyarrow holds it."""
    import pyarrow as pa

    flat = pa.array(column.reshape(-1))
    return flat if column.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, column.shape[1])


def write_words(path: Path, name: str, words: Sequence[str]) -> None:
    """Write texts with their numbers, which the column `name` holds; readers find the texts as pandas' index."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    texts, numbers = pa.array(list(words), pa.string()), pa.array(range(len(words)), pa.int64())
    columns = [
        {"name": name, "field_name": name, "pandas_type": "int64", "numpy_type": "int64", "metadata": None},
        {"name": None, "field_name": INDEX, "pandas_type": "unicode", "numpy_type": "object", "metadata": None},
    ]
    about = {"index_columns": [INDEX], "column_indexes": [], "columns": columns, "pandas_version": "2.0.0"}
    table = pa.table({name: numbers, INDEX: texts}).replace_schema_metadata({"pandas": json.dumps(about)})
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path)


def write_episodes(folder: Path, episodes: Sequence[dict[str, Any]], stats: Sequence[Stats]) -> None:
    """Write one row for each episode: where its rows and pictures are, and the statistics of its columns."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    made = [
        {
            **episode,
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
            **{f"stats/{name}/{key}": each.tolist() for name, one in found.items() for key, each in one.items()},
        }
        for episode, found in zip(episodes, stats, strict=True)
    ]
    path = folder / "meta/episodes" / place(0, "parquet")
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.Table.from_pylist(made), path)


def write_info(
    folder: Path, robot: str, rate: int, features: dict[str, Any], episodes: Sequence[dict[str, Any]], stats: Stats
) -> None:
    """Write info.json and stats.json of a dataset with `rate` rows a second."""
    pictured = any(feature["dtype"] == "video" for feature in features.values())
    names = "chunk-{chunk_index:03d}/file-{file_index:03d}"
    info = {
        "codebase_version": VERSION,
        "robot_type": robot,
        "total_episodes": len(episodes),
        "total_frames": sum(episode["length"] for episode in episodes),
        "total_tasks": len({task for episode in episodes for task in episode["tasks"]}),
        "chunks_size": CHUNK,
        "data_files_size_in_mb": TABLE_SIZE,
        "video_files_size_in_mb": FILM_SIZE,
        "fps": rate,
        "splits": {"train": f"0:{len(episodes)}"},
        "data_path": f"data/{names}.parquet",
        "video_path": f"videos/{{video_key}}/{names}.mp4" if pictured else None,
        "features": features,
    }
    numbers = {name: {key: each.tolist() for key, each in one.items()} for name, one in stats.items()}
    for name, content in (("info.json", info), ("stats.json", numbers)):
        (folder / "meta" / name).write_text(json.dumps(content, indent=4) + "\n")
