"""A simulated drive stored as a recording, with its ground truth beside it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Literal, Protocol

from situgraph.io.recording import Frame, Message
from situgraph.scenegraph.files import atomic_folder
from situgraph.sim.simulation import Simulation
from situgraph.sim.truth import TruthWriter

Format = Literal["folder", "ros2"]


class Writer(Protocol):
    """Stores messages one by one."""

    def add(self, message: Message) -> None:
        """Store one more."""

    def finish(self) -> None:
        """Complete the recording."""


def record(
    simulation: Simulation,
    path: str | Path,
    format: Format = "folder",
    on_message: Callable[[Message], None] | None = None,
) -> Path:
    """Drive, and store what the sensors give under ``path`` and the truth in ``path/truth``.

    ``on_message`` is called with each message once it is stored. The folder takes its name when
    everything is in it.

    Raises:
        InputError: ``path`` exists already or cannot be written to.
    """
    with atomic_folder(path) as folder:
        truth = TruthWriter(folder)
        writer = _writer(simulation, folder, format)
        for message in simulation.messages():
            writer.add(message)
            if isinstance(message, Frame):
                ids = simulation.truth.id_image(message.stamp)
                assert ids is not None
                truth.add_ids(message.stamp, ids)
            if on_message is not None:
                on_message(message)
        writer.finish()
        truth.finish(simulation.truth)
    return Path(path)


def _writer(simulation: Simulation, folder: Path, format: Format) -> Writer:
    if format == "ros2":
        from situgraph.io.rosbag_writer import BagWriter

        return BagWriter(folder, simulation.info)
    from situgraph.io.folder import FolderWriter

    return FolderWriter(folder, simulation.info, simulation.config.lidar.rate)
