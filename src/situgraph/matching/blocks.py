"""The memory of ``records``, laid out in Python: slots, then arrays, in one piece."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterable, Sequence
from functools import cache, lru_cache
from operator import itemgetter
from struct import pack_into
from typing import Any, Literal, NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from situgraph.matching.records import Field, Record, layout

Ints = NDArray[np.int64]
WORD = 8  # bytes of a slot, and of an element of the arrays that are laid out


class Block:
    """A record, the records in it that are not given, and all their arrays of declared sizes.

    An array is declared with its sizes, numbers or names, as ``Annotated[Floats, "rooms", 2]``; it
    is all zeros to begin with. The rest is given by the names of the fields: numbers, arrays (None
    for an empty one), records by their blocks (None for one that is not read). An array of declared
    sizes may be given by its path, as ``case.found.like``, and is not laid out then. What is given
    lives as long as the block.

    Attributes:
        place: the address of the record.
    """

    def __init__(
        self, declared: Any, sizes: dict[str, int], space: Space | None = None, **given: Any
    ) -> None:
        """Lay out a named tuple of this class; in this space, if any, which holds no other then."""
        names = tuple(given)
        self._scheme = scheme = _scheme(declared, names)
        self._sized = sized = _sized(declared, names, scheme.chosen(sizes))
        self._words = words = (
            space.cleared(sized.words) if space else np.zeros(sized.words, dtype=np.int64)
        )
        self.place = place = address(words)
        head = words[: len(sized.head)]
        np.multiply(sized.placed, place, out=head)
        head += sized.head
        self._give(given)

    def again(self, but: str, **given: Any) -> None:
        """As it was made, with all zeros in its arrays ``but`` one, and given this.

        By the same names.
        """
        begin, end, *_ = self._sized.pieces[self._scheme.laid[but][0]]
        self._words[len(self._sized.head) : begin] = 0
        self._words[end:] = 0
        self._give(given)

    def _give(self, given: dict[str, Any]) -> None:
        self._given, scheme = given, self._scheme
        flat: list[Any] = []
        for name, ndim in scheme.given:
            value = given[name]
            if ndim == 0:
                flat.append(value)
            elif ndim < 0:
                flat.append(value.place if value else 0)
            elif value is None:
                flat += (0,) * (1 + ndim)
            else:
                flat.append(address(value))
                flat += value.shape
        if flat:
            self._words[scheme.told] = flat
        if scheme.reals:
            reals = self._words.view(np.float64)
            for name, slot in scheme.reals:
                reals[slot] = given[name]

    @classmethod
    def of(cls, declared: Any, values: Iterable[Any]) -> Block:
        """A record of which all is given, field by field."""
        return cls(declared, {}, **dict(zip(layout(declared), values)))

    @property
    def words(self) -> int:
        """How large it is, in words of eight bytes."""
        return self._sized.words

    def number(self, path: str) -> float:
        """The first number of an array that was laid out, not a whole one."""
        begin = self._sized.pieces[self._scheme.laid[path][0]][0]
        return float(self._words[begin : begin + 1].view(np.float64)[0])

    def array(self, path: str) -> Any:
        """An array that was laid out, by the names of the records it is in: ``case.found.peak``."""
        k, real, ndim = self._scheme.laid[path]
        begin, end, rows, columns = self._sized.pieces[k]
        made = self._words[begin:end]
        if real:
            made = made.view(np.float64)
        return made.reshape(rows, columns) if ndim == 2 else made

    def write(self, first: str, values: Sequence[float], kind: Literal["q", "d"]) -> None:
        """Numbers from the begin of an array on, whole ones ("q") or not ("d").

        Those that it has no place for go to the arrays laid out after it.
        """
        begin = self._sized.pieces[self._scheme.laid[first][0]][0]
        pack_into(f"{len(values)}{kind}", self._words.data, begin * WORD, *values)

    def record(self, path: str) -> Laid:
        """A record that was laid out with this one: ``case.found``."""
        return Laid(self, path, int(self._words[self._scheme.inner[path]]))

    def field(self, record: str, name: str) -> Any:
        """A field of such a record: an array that was laid out, or what was given."""
        path = f"{record}.{name}"
        if path in self._scheme.laid:
            return self.array(path)
        return self._given[path if path in self._given else name]


class Space:
    """Memory for blocks, one after the other: memory that was used before is cheaper than new."""

    def __init__(self) -> None:
        """None yet."""
        self._words = np.zeros(0, dtype=np.int64)

    def cleared(self, words: int) -> Ints:
        """So many words, all zeros."""
        if words > len(self._words):
            self._words = np.zeros(max(words, len(self._words) * 3 // 2), dtype=np.int64)
            return self._words[:words]
        used = self._words[:words]
        used.fill(0)
        return used


class Laid:
    """A record within a block, as Python sees it: its arrays are made when they are asked for.

    Attributes:
        place: the address of the record.
    """

    def __init__(self, block: Block, path: str, place: int) -> None:
        """The record of this path, which is at this place."""
        self._block, self._path, self.place = block, path, place

    def __getattr__(self, name: str) -> Any:
        """A field."""
        value = self.__dict__[name] = self._block.field(self._path, name)
        return value

    def record(self, name: str) -> Laid:
        """A record in this one."""
        return self._block.record(f"{self._path}.{name}")

    @property
    def slots(self) -> Laid:
        """Itself: where it is in memory."""
        return self


def address(array: Any) -> int:
    """Where the numbers of an array are, which must be writable and C-contiguous."""
    return ctypes.addressof(_ANYWHERE.from_buffer(array))


_ANYWHERE = ctypes.c_char * 0


class Scheme(NamedTuple):
    """How a record, those in it and their arrays lie one after the other, but for the sizes."""

    numbers: tuple[int, ...]  # the sizes that are known
    chosen: Callable[[dict[str, int]], tuple[int, ...]]  # the others, of those by name
    rows: Ints  # (k,) of each piece, which size
    columns: Ints  # (k,)
    addresses: Ints  # (k - 1,) the slot of the address of each piece but the first
    lengths: Ints  # slots of the arrays' shapes
    shapes: Ints  # and which size each holds
    given: list[tuple[str, int]]  # name and dimensions, 0 of a whole number, -1 of a record
    told: Ints  # and their slots
    reals: list[tuple[str, int]]  # numbers that are not whole, and their slots
    laid: dict[str, tuple[int, bool, int]]  # arrays by path: which piece, if real, dimensions
    inner: dict[str, int]  # the records in it by path: the slot of their address


@cache
def _scheme(declared: Any, given: tuple[str, ...]) -> Scheme:
    """The scheme of a record; its fields of the names ``given`` are no inner records."""
    inner, slots = [("", declared, 0, 0)], _width(declared)
    arrays: list[tuple[str, int, Field]] = []
    known, reals = [], []
    told: list[int] = []
    for path, record, start, _ in inner:
        for name, field in layout(record).items():
            slot = start + field.slot
            if field.sizes and path + name not in given:
                arrays.append((path + name, slot, field))
            elif isinstance(field.kind, Record) and name not in given:
                inner.append((f"{path}{name}.", field.kind.declared, slots, slot))
                slots += _width(field.kind.declared)
            elif field.kind is types.float64:
                reals.append((name, slot))
            else:
                key = path + name if field.sizes else name
                known.append((key, getattr(field.kind, "ndim", -isinstance(field.kind, Record))))
                told += range(slot, slot + field.width)
    shapes = [field.sizes for _, _, field in arrays]
    pieces = [(_width(record),) for _, record, _, _ in inner] + shapes
    sizes = dict.fromkeys((1, *(s for piece in pieces for s in piece)))
    numbers = tuple(s for s in sizes if isinstance(s, int))
    names = tuple(s for s in sizes if isinstance(s, str))
    number = {size: k for k, size in enumerate((*numbers, *names))}
    return Scheme(
        numbers,
        _chooser(names),
        _ints(number[piece[0]] for piece in pieces),
        _ints(number[piece[1] if len(piece) == 2 else 1] for piece in pieces),
        _ints([*(slot for *_, slot in inner[1:]), *(slot for _, slot, _ in arrays)]),
        _ints(slot + 1 + k for _, slot, field in arrays for k in range(len(field.sizes))),
        _ints(number[size] for shape in shapes for size in shape),
        known,
        _ints(told),
        reals,
        {
            path: (k, field.kind.dtype is types.float64, field.kind.ndim)
            for k, (path, _, field) in enumerate(arrays, len(inner))
        },
        {path[:-1]: slot for path, _, _, slot in inner[1:]},
    )


def _chooser(names: tuple[str, ...]) -> Callable[[dict[str, int]], tuple[int, ...]]:
    """Picks the sizes of these names."""
    if len(names) > 1:
        return itemgetter(*names)
    return lambda sizes: tuple(sizes[name] for name in names)


class Sized(NamedTuple):
    """How all lies, sizes included."""

    words: int  # in all
    head: (
        Ints  # (slots,) of the records, but for what is given: addresses from the block's place on
    )
    placed: Ints  # (slots,) 1 where it is such an address
    pieces: list[tuple[int, int, int, int]]  # where each begins and ends, its rows and columns


@lru_cache(maxsize=256)
def _sized(declared: Any, given: tuple[str, ...], sizes: tuple[int, ...]) -> Sized:
    """How all lies; ``sizes`` are those of the scheme's names. An online graph grows seldom."""
    scheme = _scheme(declared, given)
    size = np.array((*scheme.numbers, *sizes), dtype=np.int64)
    rows, columns = size[scheme.rows], size[scheme.columns]
    ends = np.add.accumulate(rows * columns)
    pieces = [*zip([0, *ends.tolist()], ends.tolist(), rows.tolist(), columns.tolist())]
    head, placed = np.zeros((2, pieces[len(scheme.inner)][1]), dtype=np.int64)
    head[scheme.addresses], placed[scheme.addresses] = ends[:-1] * WORD, 1
    head[scheme.lengths] = size[scheme.shapes]
    return Sized(int(ends[-1]), head, placed, pieces)


def _width(declared: Any) -> int:
    return sum(field.width for field in layout(declared).values())


def _ints(values: Any) -> Ints:
    return np.array([*values], dtype=np.int64)
