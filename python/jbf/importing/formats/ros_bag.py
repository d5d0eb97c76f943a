"""ROS bags (ROS 1 files, ROS 2 folders), read by rosbags without an installation of ROS."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from jbf.errors import InputError
from jbf.importing.formats.messages import MessageSource
from jbf.importing.formats.table import Options, Source


class BagSource(MessageSource):
    """Open ROS bag; each topic is a table."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        # A ROS 2 bag is a folder, even if the user names a file in it.
        bag = path.parent if path.suffix == ".db3" else path
        store = get_typestore(Stores.ROS2_HUMBLE)
        self._reader = AnyReader([bag], default_typestore=store)
        self._reader.open()
        self.origin_ns = self._reader.start_time
        for topic, info in self._reader.topics.items():
            if info.msgcount:
                self.add_topic(topic, info.msgcount)
        if not self.tables:
            raise InputError(
                file=path, problem="contains no numeric messages", remedy="name another file"
            )

    def messages(self, topic: str) -> Iterable[tuple[int, Any]]:
        """Yield log time, ns, and decoded message of each message of a topic."""
        connections = [c for c in self._reader.connections if c.topic == topic]
        for connection, stamp, raw in self._reader.messages(connections=connections):
            yield stamp, self._reader.deserialize(raw, connection.msgtype)

    def close(self) -> None:
        """Close the bag."""
        self._reader.close()


def open_bag(path: Path, options: Options) -> Source:
    """Open a ROS bag as a source of tables."""
    return BagSource(path)
