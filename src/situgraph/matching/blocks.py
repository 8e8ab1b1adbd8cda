"""The memory of ``records``, laid out in Python: slots, then arrays, in one piece."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from functools import cache
from typing import Any, NamedTuple

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
    for an empty one), records by their blocks. What is given lives as long as the block.

    Attributes:
        place: the address of the record.
    """

    def __init__(self, declared: Any, sizes: dict[str, int], **given: Any) -> None:
        """Lay out a named tuple of this class."""
        self._given = given
        self._scheme = scheme = _scheme(declared, tuple(given))
        sized = [sizes[s] if isinstance(s, str) else s for s in scheme.sizes]
        size = np.array(sized, dtype=np.int64)
        self._rows, self._columns = size[scheme.rows], size[scheme.columns]
        self._ends = ends = np.add.accumulate(self._rows * self._columns)
        self._words = slots = np.zeros(int(ends[-1]), dtype=np.int64)
        self._reals = slots.view(np.float64)
        self.place = address(slots)
        slots[scheme.arrays] = ends[:-1] * WORD + self.place
        slots[scheme.lengths] = size[scheme.shapes]
        slots[scheme.records] = scheme.begins + self.place
        flat: list[int] = []
        for name, ndim in scheme.given:
            value = given[name]
            if ndim == 0:
                flat.append(value)
            elif ndim < 0:
                flat.append(value.place)
            elif value is None:
                flat += (0,) * (1 + ndim)
            else:
                flat.append(address(value))
                flat += value.shape
        slots[scheme.told] = flat
        for name, slot in scheme.reals:
            self._reals[slot] = given[name]

    @classmethod
    def of(cls, declared: Any, values: Iterable[Any]) -> Block:
        """A record of which all is given, field by field."""
        return cls(declared, {}, **dict(zip(layout(declared), values)))

    def array(self, path: str) -> Any:
        """An array that was laid out, by the names of the records it is in: ``case.found.peak``."""
        k, real, ndim = self._scheme.laid[path]
        made = (self._reals if real else self._words)[self._ends[k - 1] : self._ends[k]]
        return made.reshape(self._rows[k], self._columns[k]) if ndim == 2 else made

    def arrays(self) -> dict[str, Any]:
        """The arrays of the record itself that were laid out, by name."""
        return {path: self.array(path) for path in self._scheme.laid if "." not in path}


def address(array: Any) -> int:
    """Where the numbers of an array are, which must be writable and C-contiguous."""
    return ctypes.addressof(_ANYWHERE.from_buffer(array))


_ANYWHERE = ctypes.c_char * 0


class Scheme(NamedTuple):
    """How records are laid out, but for sizes that are known later."""

    sizes: tuple[int | str, ...]
    rows: Ints  # (k + 1,) which size, of all slots and of each array
    columns: Ints  # (k + 1,)
    arrays: Ints  # (k,) the slot of each array's address
    lengths: Ints  # slots of the arrays' shapes
    shapes: Ints  # and which size each holds
    records: Ints  # the slot of each inner record's address
    begins: Ints  # and where that begins, in bytes
    given: list[tuple[str, int]]  # name and dimensions, 0 of a whole number, -1 of a record
    told: Ints  # and their slots
    reals: list[tuple[str, int]]  # numbers that are not whole, and their slots
    laid: dict[str, tuple[int, bool, int]]  # of each array by its path: which, if real, dimensions


@cache
def _scheme(declared: Any, given: tuple[str, ...]) -> Scheme:
    """The scheme of a record; its fields of the names ``given`` are no inner records."""
    todo, slots = [("", declared, 0)], _width(declared)
    arrays: list[tuple[str, int, Field]] = []
    inner, known, reals = [], [], []
    told: list[int] = []
    for path, record, start in todo:
        for name, field in layout(record).items():
            slot = start + field.slot
            if field.sizes:
                arrays.append((path + name, slot, field))
            elif isinstance(field.kind, Record) and name not in given:
                inner.append((slot, slots * WORD))
                todo.append((f"{path}{name}.", field.kind.declared, slots))
                slots += _width(field.kind.declared)
            elif field.kind is types.float64:
                reals.append((name, slot))
            else:
                known.append((name, getattr(field.kind, "ndim", -isinstance(field.kind, Record))))
                told += range(slot, slot + field.width)
    shapes = [field.sizes for _, _, field in arrays]
    sizes = tuple(dict.fromkeys((slots, 1, *(s for shape in shapes for s in shape))))
    number = {size: k for k, size in enumerate(sizes)}
    return Scheme(
        sizes,
        _ints(number[shape[0]] for shape in [(slots,), *shapes]),
        _ints(number[shape[1] if len(shape) == 2 else 1] for shape in [(slots,), *shapes]),
        _ints(slot for _, slot, _ in arrays),
        _ints(slot + 1 + k for _, slot, field in arrays for k in range(len(field.sizes))),
        _ints(number[size] for shape in shapes for size in shape),
        _ints(slot for slot, _ in inner),
        _ints(begin for _, begin in inner),
        known,
        _ints(told),
        reals,
        {
            path: (k, field.kind.dtype is types.float64, field.kind.ndim)
            for k, (path, _, field) in enumerate(arrays, 1)
        },
    )


def _width(declared: Any) -> int:
    return sum(field.width for field in layout(declared).values())


def _ints(values: Any) -> Ints:
    return np.array([*values], dtype=np.int64)
