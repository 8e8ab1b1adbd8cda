"""Tables handed to kernels by address.

A named tuple of arrays is passed to compiled code field by field, hundreds of values a call,
which makes calls slow and compiling them slower. ``pointer`` puts a tuple on the caller's stack
and gives its address; ``read`` reads it back. Arrays read through a pointer are borrowed: they
live as long as the kernel that made the pointer runs, so they need no reference counting.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def pointer(_: Any, record: Any) -> Any:
    """The address of a copy of ``record`` that lives as long as the calling kernel runs."""

    def generate(_context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return cgutils.alloca_once_value(builder, args[0])

    return types.CPointer(record)(record), generate


@intrinsic
def read(_: Any, address: Any) -> Any:
    """The record that ``pointer`` was given."""
    record = address.dtype

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return _load(context, builder, record, args[0])

    return record(address), generate


def _load(context: Any, builder: Any, kind: Any, address: Any) -> Any:
    if isinstance(kind, types.Array):
        return _load_array(context, builder, kind, address)
    if isinstance(kind, types.BaseNamedTuple):
        value = context.get_constant_undef(kind)
        for k, member in enumerate(kind):
            place = cgutils.gep_inbounds(builder, address, 0, k)
            value = builder.insert_value(value, _load(context, builder, member, place), k)
        return value
    return builder.load(address)


def _load_array(context: Any, builder: Any, kind: Any, address: Any) -> Any:
    source = context.make_array(kind)(context, builder, ref=address)
    target = context.make_array(kind)(context, builder)
    for name in ("nitems", "itemsize", "data", "shape", "strides"):
        setattr(target, name, getattr(source, name))
    for name in ("meminfo", "parent"):  # nobody counts what is borrowed
        setattr(target, name, cgutils.get_null_value(getattr(source, name).type))
    return target._getvalue()
