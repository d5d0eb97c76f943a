"""MCAP logs, by mcap and mcap-ros2-support: ROS 2 messages and JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from mcap.decoder import DecoderFactory
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory as Ros2Decoder

from jbf.errors import InputError
from jbf.importing.formats.messages import MessageSource
from jbf.importing.formats.table import Options, Source


class _JsonDecoder(DecoderFactory):
    """Decoder of JSON messages."""

    def decoder_for(self, message_encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
        return json.loads if message_encoding == "json" else None


class McapSource(MessageSource):
    """Open MCAP log; each topic is a table."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._file = path.open("rb")
        summary = make_reader(self._file).get_summary()
        if summary is None:
            raise InputError(file=path, problem="has no summary", remedy="mcap recover FILE")
        self.origin_ns = summary.statistics.message_start_time if summary.statistics else 0
        counts = summary.statistics.channel_message_counts if summary.statistics else {}
        encodings = {c.message_encoding for c in summary.channels.values()} - {"cdr", "json"}
        for number, channel in summary.channels.items():
            if channel.message_encoding in ("cdr", "json"):
                self.add_topic(channel.topic, counts.get(number))
        if not self.tables:
            contents = f" (it contains {', '.join(sorted(encodings))})" if encodings else ""
            problem = f"contains no numeric messages of ROS 2 or JSON{contents}"
            raise InputError(file=path, problem=problem, remedy="write its messages as JSON or CSV")

    def messages(self, topic: str) -> Iterable[tuple[int, Any]]:
        """Yield log time, ns, and decoded message of each message of a topic."""
        self._file.seek(0)
        reader = make_reader(self._file, decoder_factories=[Ros2Decoder(), _JsonDecoder()])
        for _, _, message, decoded in reader.iter_decoded_messages(topics=[topic]):
            yield message.log_time, decoded

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def open_mcap(path: Path, options: Options) -> Source:
    """Open an MCAP log as a source of tables."""
    return McapSource(path)
