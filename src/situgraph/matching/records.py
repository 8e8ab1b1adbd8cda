"""Records of arrays, handed to kernels by address.

A named tuple of arrays is passed to compiled code field by field, hundreds of values a call, and
numpy arrays carry counts of references: both make compiling slow. Here a record is made
of 8-byte slots, filled in Python (``blocks``): a number takes one; an array takes its address and
its shape; a record takes its address. In kernels ``record.field`` is a number, a ``Vector`` or a
record.

A ``Vector`` is a C-contiguous array of one or two dimensions that nobody counts: it lives as long
as the array it was made of. Indices are not checked, and negative ones mean nothing.
"""

# mypy: disable-error-code="no-untyped-def,no-untyped-call"
from __future__ import annotations

import operator
from functools import cache
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from llvmlite import ir  # type: ignore[import-untyped]
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import (
    AbstractTemplate,
    AttributeTemplate,
    infer_getattr,
    infer_global,
    signature,
)
from numba.extending import (
    intrinsic,
    lower_builtin,
    lower_getattr_generic,
    models,
    register_model,
)
from numba.np.numpy_support import from_dtype

SLOTS = "slots"  # the field of a record that holds its block, where it is kept


class Field(NamedTuple):
    """A field of a record: where its slots begin, what it is, its shape where that is declared."""

    slot: int
    kind: Any
    sizes: tuple[int | str, ...]

    @property
    def width(self) -> int:
        """How many slots."""
        return 1 + getattr(self.kind, "ndim", 0)


class Vector(types.Type):
    """An array of numbers."""

    def __init__(self, dtype: Any, ndim: int) -> None:
        """Of so many dimensions."""
        self.dtype, self.ndim = dtype, ndim
        super().__init__(f"vector({dtype}, {ndim})")


class Record(types.Type):
    """A block of slots, laid out as a named tuple declares."""

    def __init__(self, declared: Any) -> None:
        """Laid out as ``declared``."""
        self.declared = declared
        super().__init__(f"record({declared.__module__}.{declared.__qualname__})")


@cache
def layout(declared: Any) -> dict[str, Field]:
    """The fields of a named tuple, in slots."""
    fields, at = {}, 0
    for name, hint in get_type_hints(declared, include_extras=True).items():
        if name == SLOTS:
            continue
        kind, sizes = _kind(hint)
        fields[name] = field = Field(at, kind, sizes)
        at += field.width
    return fields


def _kind(hint: Any) -> tuple[Any, tuple[int | str, ...]]:
    """What a field is, and the shape of an array that is laid out with its record."""
    if hint is int:
        return types.int64, ()
    if hint is float:
        return types.float64, ()
    shape: tuple[Any, ...] = (None,)
    if get_origin(hint) is Annotated:
        hint, *shape = get_args(hint)  # type: ignore[assignment]
    # NDArray is an alias of the language from Python 3.12 on.
    named = getattr(get_origin(hint), "__value__", None)
    if named is not None:
        hint = named[get_args(hint)]
    if get_origin(hint) is np.ndarray:
        (scalar,) = get_args(get_args(hint)[1])
        dtype = types.uint8 if scalar is np.bool_ else from_dtype(np.dtype(scalar))
        return Vector(dtype, len(shape)), () if None in shape else tuple(shape)
    return Record(hint), ()


@register_model(Vector)
class VectorModel(models.StructModel):
    """The address and the shape."""

    def __init__(self, manager: Any, kind: Any) -> None:
        """Members of the struct."""
        members = [("data", types.CPointer(kind.dtype)), ("n", types.intp)]
        if kind.ndim == 2:
            members.append(("m", types.intp))
        super().__init__(manager, kind, members)


@register_model(Record)
class RecordModel(models.PrimitiveModel):
    """The address."""

    def __init__(self, manager: Any, kind: Any) -> None:
        """A pointer to slots."""
        super().__init__(manager, kind, ir.IntType(64).as_pointer())


@infer_getattr
class RecordFields(AttributeTemplate):
    """Types of the fields of a record."""

    key = Record

    def generic_resolve(self, record: Any, name: str) -> Any:
        """The type of one field."""
        return layout(record.declared)[name].kind


@lower_getattr_generic(Record)
def read_field(context: Any, builder: Any, record: Any, value: Any, name: str) -> Any:
    """Load a field from its slots."""
    field = layout(record.declared)[name]
    words = [_load(builder, value, field.slot + k) for k in range(field.width)]
    kind = context.get_value_type(field.kind)
    if isinstance(field.kind, Vector):
        made = cgutils.create_struct_proxy(field.kind)(context, builder)
        made.data = builder.inttoptr(words[0], made.data.type)
        made.n = words[1]
        if field.kind.ndim == 2:
            made.m = words[2]
        return made._getvalue()
    if isinstance(field.kind, Record):
        return builder.inttoptr(words[0], kind)
    return builder.bitcast(words[0], kind)


def _load(builder: Any, pointer: Any, slot: int) -> Any:
    return builder.load(builder.gep(pointer, [ir.Constant(ir.IntType(64), slot)], inbounds=True))


@intrinsic
def record_at(_: Any, place: Any, declared: Any) -> Any:
    """The record of a class at an address."""
    record = Record(declared.instance_class if hasattr(declared, "instance_class") else declared)

    def generate(context: Any, builder: Any, _signature: Any, args: Any) -> Any:
        return builder.inttoptr(args[0], context.get_value_type(record))

    return record(types.intp, declared), generate


@intrinsic(prefer_literal=True)
def scratch(_: Any, size: Any) -> Any:
    """A vector of ``size`` (a constant) floats on the stack of the kernel that asks for it."""
    kind = Vector(types.float64, 1)
    length = size.literal_value

    def generate(context: Any, builder: Any, _signature: Any, _args: Any) -> Any:
        made = cgutils.create_struct_proxy(kind)(context, builder)
        place = cgutils.alloca_once(builder, ir.ArrayType(ir.DoubleType(), length))
        made.data = builder.bitcast(place, made.data.type)
        made.n = ir.Constant(ir.IntType(64), length)
        return made._getvalue()

    return kind(size), generate


@infer_global(len)
class VectorLength(AbstractTemplate):
    """``len(vector)``."""

    def generic(self, args: Any, kws: Any) -> Any:
        """Its type."""
        if not kws and len(args) == 1 and isinstance(args[0], Vector):
            return signature(types.intp, args[0])
        return None


@lower_builtin(len, Vector)
def _length(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return cgutils.create_struct_proxy(sig.args[0])(context, builder, args[0]).n


def _index_type(vector: Any, index: Any) -> Any:
    """The type an index is converted to, and whether it names a row; None when it is no index."""
    if isinstance(index, types.Integer):
        return types.intp
    pair = isinstance(index, types.BaseTuple) and len(index) == 2 and vector.ndim == 2
    return types.UniTuple(types.intp, 2) if pair else None


@infer_global(operator.getitem)
class VectorRead(AbstractTemplate):
    """``vector[i]``, ``vector[i, j]``; a row of two dimensions is a vector."""

    def generic(self, args: Any, kws: Any) -> Any:
        """Its type."""
        vector, index = args
        if not isinstance(vector, Vector) or (wanted := _index_type(vector, index)) is None:
            return None
        row = vector.ndim == 2 and wanted is types.intp
        return signature(Vector(vector.dtype, 1) if row else vector.dtype, vector, wanted)


@infer_global(operator.setitem)
class VectorWrite(AbstractTemplate):
    """``vector[i] = x``, ``vector[i, j] = x``."""

    def generic(self, args: Any, kws: Any) -> Any:
        """Its type."""
        vector, index, _ = args
        if not isinstance(vector, Vector) or (wanted := _index_type(vector, index)) is None:
            return None
        return signature(types.none, vector, wanted, vector.dtype)


def _place(builder: Any, kind: Any, vector: Any, index: Any) -> Any:
    """The address of an element, or of a row."""
    if kind.ndim == 1:
        pass
    elif isinstance(index.type, ir.IntType):
        index = builder.mul(index, vector.m)
    else:
        row, column = (builder.extract_value(index, k) for k in range(2))
        index = builder.add(builder.mul(row, vector.m), column)
    return builder.gep(vector.data, [index], inbounds=True)


def _struct(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    return cgutils.create_struct_proxy(kind)(context, builder, value)


@lower_builtin(operator.getitem, Vector, types.Any)
def _read(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    vector = _struct(context, builder, sig.args[0], args[0])
    place = _place(builder, sig.args[0], vector, args[1])
    if not isinstance(sig.return_type, Vector):
        return builder.load(place)
    row = cgutils.create_struct_proxy(sig.return_type)(context, builder)
    row.data, row.n = place, vector.m
    return row._getvalue()


@lower_builtin(operator.setitem, Vector, types.Any, types.Any)
def _write(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    vector = _struct(context, builder, sig.args[0], args[0])
    builder.store(args[2], _place(builder, sig.args[0], vector, args[1]))
    return context.get_dummy_value()
