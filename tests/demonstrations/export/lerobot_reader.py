"""Reads rows with the real LeRobotDataset, and prints them as JSON; runs in an environment that has lerobot.

python lerobot_reader.py FOLDER ROW ROW ...
"""

from __future__ import annotations

import json
import sys

from lerobot.datasets.lerobot_dataset import LeRobotDataset


def main(folder: str, *rows: str) -> None:
    data = LeRobotDataset("hazard/test", root=folder, video_backend="pyav")
    read = [data[int(row)] for row in rows]
    made = [{key: entry if isinstance(entry, str) else entry.tolist() for key, entry in row.items()} for row in read]
    print(json.dumps({"episodes": data.num_episodes, "rows": len(data), "rate": data.fps, "read": made}))


if __name__ == "__main__":
    main(*sys.argv[1:])
