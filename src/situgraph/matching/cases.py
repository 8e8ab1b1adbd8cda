"""What a ``Case`` is made of: its tables, and the sizes of the room to work in."""

from __future__ import annotations

from typing import Any, NamedTuple

from situgraph.matching.boxes import SIDES
from situgraph.matching.nearby import BUCKETS
from situgraph.matching.tables import Aim, Content, Limits, Plan, Seen

WAITING = 64  # boxes of one pair of rooms that are put together
BESIDE = 64  # rows of the sieve beyond those of a map
DEPTH = 256  # of the stack of boxes: each is halved until it is smaller than a millimetre


class Tables(NamedTuple):
    """What is compared, and how."""

    seen: Seen
    plan: Plan
    limits: Limits
    content: Content
    room: dict[str, int]  # sizes of the room to work in, ``words`` those of one map

    @property
    def turn(self) -> float:
        """The yaw that takes the first wall seen to the first one planned, 0 without any."""
        theirs, mine = self.plan.row, self.seen.angle
        return float(theirs[0, 3] - mine[0]) if len(theirs) and len(mine) else 0.0

    def given(self, aim: Aim) -> dict[str, Any]:
        """What the block of a ``Case`` is given."""
        return {
            "seen": self.seen.slots,
            "plan": self.plan.slots,
            "limits": self.limits.slots,
            "content": self.content.slots,
            "least": aim.least,
            "budget": aim.budget,
            "loss": aim.loss,
            "base": self.turn,
            "layers": 1,
            "former": None,
        }

    def sizes(
        self, *, peaks: int = 0, boxes: int = 0, maps: bool = False, shared: bool = False
    ) -> dict[str, int]:
        """The sizes of a ``Case``; whether ``maps`` are drawn, of one shift of the storeys.

        They may be ``shared`` with the search for the mirror image.
        """
        room = self.room
        drawn = {"maps": maps * room["N"], "words": maps * room["words"]}
        drawn["shared"] = room["N"] + room["words"] if shared else 0
        return room | {"peaks": peaks, "boxes": boxes} | drawn


def room_for(plan: Plan) -> dict[str, int]:
    """The part of ``Tables.room`` that the plan alone tells."""
    prior, (wide, tall) = len(plan.storey), plan.cells.tolist()
    return {
        "M": prior,
        "m": plan.widest + 1,
        "buckets": BUCKETS,
        "depth": DEPTH,
        "waiting": WAITING,
        "sides": SIDES,
        "like": prior // 64 + 1,
        "map": 4 * wide * tall,
        "blocks": (wide // 8 + 1) * (tall // 8 + 1),
        "left": 64 + 16 * wide * tall,
        "height": tall + BESIDE,
    }


def room_of(sizes: dict[str, int], plan: dict[str, int], storeys: int) -> dict[str, int]:
    """``Tables.room`` for so many online storeys, of the sizes of a ``Drafting`` and of a plan."""
    rooms = sizes["N"]
    return (
        sizes
        | plan
        | {
            "N + 2": rooms + 2,
            "M + N": plan["M"] + rooms,
            "U": storeys,
            "words": rooms * plan["map"] // 2,
            "sums": 3 + 2 * rooms.bit_length(),  # what is left, two carried, digits, waiting marks
        }
    )
