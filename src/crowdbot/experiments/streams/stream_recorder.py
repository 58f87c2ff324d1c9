"""StreamRecorder: numeric streams of the Lab Streaming Layer in the folder of a session."""

from __future__ import annotations

import contextlib
import csv
import json
import re
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from crowdbot.core import CrowdbotError, EpisodeError, InputError

from .lab_streaming_layer import load_pylsl
from .recorded_stream import COLUMNS, STREAMS

INTERVAL = 0.05
"""Time between two reads [s]."""
OFFSET_INTERVAL = 1.0
"""Time between two estimates of the offset of a clock [s]."""
CHUNK = 4096
PROPERTIES = ("name", "type", "source_id")


class StreamRecorder:
    """Records streams in a thread until it is closed.

    Each stream becomes ``streams/NAME.csv`` with the time stamp of each sample in the clock of the sender, the
    estimated offset of that clock, the same instant in the monotonic clock of this computer, and the channels;
    ``streams/NAME.json`` describes it. :func:`read_streams` reads them. A stream that is lost is continued when its
    sender is back.

    Args:
        folder: folder of the participant.
        streams: names of streams, or ``PROPERTY=VALUE`` such as ``type=EEG``, for all streams with it.
        wait: longest time [s] to wait for each of them.

    Raises:
        InputError: there is no such stream, or it carries texts.
        EpisodeError: a file cannot be written.
        MissingExtra: the package ``pylsl`` is not installed.
    """

    def __init__(self, folder: Path, streams: Sequence[str], wait: float = 5.0) -> None:
        self._lsl, self._stop = load_pylsl(), threading.Event()
        self._error: CrowdbotError | None = None
        found = [info for one in streams for info in self._resolve(one, wait)]
        unique = {info.uid(): info for info in found}
        self._writers: list[_StreamWriter] = []
        try:
            for info in unique.values():
                self._writers.append(_StreamWriter(self._lsl, info, folder / STREAMS, wait))
        except BaseException:
            self._end()
            raise
        self._thread = threading.Thread(target=self._run, name="crowdbot-streams", daemon=True)
        self._thread.start()

    def __enter__(self) -> StreamRecorder:
        """Return the recorder."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the files."""
        self.close()

    @property
    def counts(self) -> dict[str, int]:
        """Number of recorded samples of each file."""
        return {writer.path.stem: writer.count for writer in self._writers}

    def close(self) -> None:
        """Read what has arrived and close the files.

        Raises:
            EpisodeError: a file could not be written.
        """
        self._stop.set()
        self._thread.join()
        if self._error is not None:
            raise self._error

    def _resolve(self, text: str, wait: float) -> list[Any]:
        name, equals, value = text.partition("=")
        chosen = (name, value) if equals and name in PROPERTIES else ("name", text)
        found: list[Any] = self._lsl.resolve_byprop(*chosen, 1, wait)
        if not found:
            raise InputError(f"there is no stream with the {chosen[0]} {chosen[1]!r} in the Lab Streaming Layer")
        return found

    def _run(self) -> None:
        try:
            while not self._stop.wait(INTERVAL):
                for writer in self._writers:
                    writer.write()
            for writer in self._writers:
                writer.write()
        except OSError as error:
            self._error = EpisodeError(f"cannot write {error.filename or 'a stream'}: {error.strerror}")
        finally:
            self._end()

    def _end(self) -> None:
        for writer in self._writers:
            writer.close()


class _StreamWriter:
    """Reads one stream and writes its files."""

    def __init__(self, lsl: Any, info: Any, folder: Path, wait: float) -> None:
        if info.channel_format() == lsl.cf_string:
            raise InputError(f"the stream {info.name()!r} carries texts; only streams of numbers are recorded")
        self._lsl, self.count = lsl, 0
        self._inlet = lsl.StreamInlet(info)
        try:
            self._inlet.open_stream(wait)
            self._offset, self._next = self._inlet.time_correction(wait), time.monotonic() + OFFSET_INTERVAL
            whole = self._inlet.info(wait)
        except RuntimeError:  # base of the errors of pylsl
            raise InputError(f"the stream {info.name()!r} does not answer within {wait:g} s") from None
        labels = [one or f"channel_{k}" for k, one in enumerate(_texts(whole.get_channel_labels(), info), 1)]
        head = {
            "name": info.name(),
            "type": info.type(),
            "source": info.source_id(),
            "host": info.hostname(),
            "rate": info.nominal_srate(),
            "labels": labels,
            "units": _texts(whole.get_channel_units(), info),
        }
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self.path = _free(folder, re.sub(r"[^\w.-]+", "-", info.name()).strip(".-") or "stream")
            self.path.with_suffix(".json").write_text(json.dumps(head, ensure_ascii=False) + "\n", encoding="utf-8")
            self._file = self.path.open("x", encoding="utf-8", newline="")
            csv.writer(self._file, lineterminator="\n").writerow([*COLUMNS, *labels])
        except OSError as error:
            raise EpisodeError(f"cannot write {folder}: {error.strerror}") from None

    def write(self) -> None:
        """Write the samples that have arrived."""
        if time.monotonic() >= self._next:
            with contextlib.suppress(RuntimeError):  # the sender is away: the latest estimate counts
                self._offset = self._inlet.time_correction(0.2)
            self._next = time.monotonic() + OFFSET_INTERVAL
        own = time.monotonic() - self._lsl.local_clock()
        values, stamps = self._inlet.pull_chunk(timeout=0.0, max_samples=CHUNK)
        while stamps:
            for row, stamp in zip(values, stamps, strict=True):
                clock = stamp + self._offset + own
                self._file.write(f"{stamp:.6f},{self._offset:.9f},{clock:.6f},{','.join(map(repr, row))}\n")
            self.count += len(stamps)
            values, stamps = self._inlet.pull_chunk(timeout=0.0, max_samples=CHUNK)
        self._file.flush()

    def close(self) -> None:
        """Close the file and the stream."""
        self._file.close()
        self._inlet.close_stream()


def _texts(given: list[str | None] | None, info: Any) -> list[str]:
    """Return a text for each channel, empty if the sender gives none."""
    texts = [one or "" for one in given or []]
    return (texts + [""] * info.channel_count())[: info.channel_count()]


def _free(folder: Path, name: str) -> Path:
    """Return a path that does not exist: a resumed session has several parts."""
    paths = (folder / (f"{name}-{k}.csv" if k > 1 else f"{name}.csv") for k in range(1, 10_000))
    return next(path for path in paths if not path.exists())
