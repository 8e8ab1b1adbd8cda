"""Kernels that only other kernels call are lowered, but optimised once, where they end up.

Numba optimises and emits machine code for each function on its own, together with all functions
it calls. In a deep tree of calls the leaves are compiled again for each level; that was three
quarters of the time the matcher took to compile. A part is only written in LLVM's language; the
entry joins all parts in one text, has it parsed, optimises the whole program, and emits it, once.
"""

from __future__ import annotations

import gc
from functools import cache
from typing import Any

from llvmlite import binding as llvm  # type: ignore[import-untyped]
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.codegen import CodeLibrary, JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import register_pass
from numba.core.ir import UNDEFINED
from numba.core.ir_utils import build_definitions
from numba.core.lowering import Lower
from numba.core.ssa import reconstruct_ssa
from numba.core.typed_passes import (
    AnnotateTypes,
    InlineOverloads,
    IRLegalization,
    NativeLowering,
    NopythonRewrites,
    NoPythonSupportedFeatureValidation,
)
from numba.core.untyped_passes import (
    DeadBranchPrune,
    FindLiterallyCalls,
    InlineClosureLikes,
    InlineInlinables,
    IRProcessing,
    LiteralPropagationSubPipelinePass,
    LiteralUnroll,
    MakeFunctionToJitFunction,
    ReconstructSSA,
    RewriteDynamicRaises,
    RewriteSemanticConstants,
    WithLifting,
)

_METADATA: tuple[list[Any], dict[Any, Any]] = ([], {})


class PartLibrary(JITCodeLibrary):
    """A part in LLVM's language as numba wrote it: not parsed, never run by itself."""

    module: ir.Module
    _linking_libraries: list[Any]

    def __init__(self, codegen: Any, name: str) -> None:
        """Arguments as those of numba's; no module to link anything into."""
        CodeLibrary.__init__(self, codegen, name)
        self._linking_libraries = []

    def create_ir_module(self, name: str) -> ir.Module:
        """A module that numbers its metadata with all others."""
        return _numbered(super().create_ir_module(name))

    def add_ir_module(self, ir_module: ir.Module) -> None:
        """Keep what was written."""
        self.module = ir_module

    def finalize(self) -> None:
        """Nothing is linked yet: else what is deep in the tree would be copied at every level."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """No address: no machine code was emitted."""
        return 0

    @property
    def codegen(self) -> PartLibrary:
        """Itself, as far as the environment of a function goes, which a part does not have."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Nothing runs that would want an environment."""

    def create_library(self, *args: Any, **options: Any) -> Any:
        """A library of the usual kind."""
        return self._codegen.create_library(*args, **options)


class EntryLibrary(JITCodeLibrary):
    """A program: an entry and the parts it calls, directly or not."""

    _program: ir.Module
    _linking_libraries: list[Any]

    def create_ir_module(self, name: str) -> ir.Module:
        """The module of the entry itself, to which its parts are added."""
        self._program = _numbered(super().create_ir_module(name))
        return self._program

    def add_ir_module(self, ir_module: ir.Module) -> None:
        """What Python calls the entry by; the entry itself waits for its parts."""
        if ir_module is not self._program:
            super().add_ir_module(ir_module)

    def finalize(self) -> None:
        """Join the parts in one text, parse it, optimise it and emit machine code."""
        called = dict.fromkeys(self._linking_libraries)
        for library in (waiting := list(called)):
            if isinstance(library, PartLibrary):
                more = [one for one in library._linking_libraries if one not in called]
                called.update(dict.fromkeys(more))
                waiting += dict.fromkeys(more)
                _join(self._program, library.module)
        self._linking_libraries = [one for one in called if not isinstance(one, PartLibrary)]
        program = llvm.parse_assembly(str(self._program))
        program.data_layout = self._codegen._data_layout
        self._final_module.link_in(program)
        super().finalize()

    def _optimize_final_module(self) -> None:
        """Once: there are no counts of references, for whose sake numba does it twice."""
        passes, builder = self._codegen._module_pass_manager(opt=2)
        passes.run(self._final_module, builder)


def _join(program: ir.Module, module: ir.Module) -> None:
    """Add what a part defines, for the program alone, and what it declares."""
    for name, value in module.globals.items():
        if isinstance(value, ir.Function) and not value.is_declaration:
            value.linkage = value.linkage or "internal"
            program.globals[name] = value
        else:
            program.globals.setdefault(name, value)


def _numbered(module: ir.Module) -> ir.Module:
    """The same module; its metadata have numbers that no other's have, so it can be joined."""
    module.metadata, module._metadatacache = _METADATA
    return module


class PartLower(Lower):
    """Lowering without what only a debugger would want, and with signatures that are known."""

    def lower_binop(self, resty: Any, expr: Any, op: Any) -> Any:
        """An operator; numba tries others where an operand is constant, as in powers."""
        if expr.static_lhs is not UNDEFINED or expr.static_rhs is not UNDEFINED:
            return super().lower_binop(resty, expr, op)
        signature = self.fndesc.calltypes[expr]
        sides = [
            self.context.cast(self.builder, self.loadvar(side.name), self.typeof(side.name), kind)
            for side, kind in zip((expr.lhs, expr.rhs), signature.args)
        ]
        typing = self.context.typing_context
        called = typing.resolve_value_type(op)
        made = self.context.get_function(called, _signature(typing, called, signature.args))
        value = made(self.builder, sides)
        return self.context.cast(self.builder, value, signature.return_type, resty)

    def alloca_lltype(self, name: str, lltype: Any, datamodel: Any = None) -> Any:
        """Room for a variable on the stack."""
        return cgutils.alloca_once(self.builder, lltype, name=name)


@register_pass(mutates_CFG=True, analysis_only=False)
class LowerPart(NativeLowering):
    """Lowering into a library that is only linked."""

    _name = "lower_part"
    lowering_class = PartLower

    def run_pass(self, state: Any) -> bool:
        """Lower one function."""
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=True, analysis_only=False)
class LowerEntry(NativeLowering):
    """Lowering into a program."""

    _name = "lower_entry"

    def run_pass(self, state: Any) -> bool:
        """Lower the entry itself, and link its parts."""
        state.library = EntryLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return bool(super().run_pass(state))


@register_pass(mutates_CFG=False, analysis_only=False)
class PartSSA(ReconstructSSA):
    """Variables assigned once, without a look at how long they live: phis are stripped next."""

    _name = "part_ssa"

    def run_pass(self, state: Any) -> bool:
        """Rewrite one function."""
        state.func_ir = reconstruct_ssa(state.func_ir)
        state.func_ir._definitions = build_definitions(state.func_ir.blocks)
        return True


# Passes for arrays, closures, objects and literals, of which parts have none.
NOT_FOR_PARTS = (
    IRProcessing,
    WithLifting,
    InlineClosureLikes,
    RewriteSemanticConstants,
    DeadBranchPrune,
    RewriteDynamicRaises,
    MakeFunctionToJitFunction,
    InlineInlinables,
    FindLiterallyCalls,
    LiteralUnroll,
    LiteralPropagationSubPipelinePass,
    InlineOverloads,
    NopythonRewrites,
    NoPythonSupportedFeatureValidation,
    IRLegalization,
    AnnotateTypes,
)


INSTEAD = {
    ReconstructSSA: PartSSA,
    NativeLowering: LowerPart,
}


@cache
def _signature(context: Any, function: Any, args: tuple[Any, ...]) -> Any:
    """What a function of numba's returns for such arguments: asked once, not for each operator."""
    return context.resolve_function_type(function, args, {})


class PartTyping:
    """A context of types that remembers the signatures of all that is not a kernel."""

    def __init__(self, context: Any) -> None:
        """The same as ``context`` otherwise."""
        self._context = context

    def __getattr__(self, name: str) -> Any:
        """As in that context."""
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, args: tuple[Any, ...], kws: Any) -> Any:
        """The signature of a call."""
        if kws or isinstance(function, types.Dispatcher):
            return self._context.resolve_function_type(function, args, kws)
        return _signature(self._context, function, args)


class EntryCompiler(Compiler):
    """Numba's compiler while nobody looks for garbage: of millions of objects there is little."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function, with all its parts."""
        before = gc.get_threshold()
        gc.set_threshold(100_000, 50, 100)
        try:
            return super().compile_extra(function)
        finally:
            gc.set_threshold(*before)

    def define_pipelines(self) -> Any:
        """The usual passes; lowering replaced."""
        return _replaced(super().define_pipelines(), {NativeLowering: LowerEntry})


class PartCompiler(Compiler):
    """Numba's compiler, but for the last step, and for passes that would find nothing to do."""

    def __init__(self, typingctx: Any, *args: Any) -> None:
        """Arguments as those of numba's."""
        super().__init__(typingctx, *args)
        self.state.typingctx = PartTyping(typingctx)

    def define_pipelines(self) -> Any:
        """The usual passes; lowering replaced."""
        steps = dict.fromkeys(NOT_FOR_PARTS) | INSTEAD
        return _replaced(super().define_pipelines(), steps)


def _replaced(pipelines: Any, steps: dict[Any, Any]) -> Any:
    """Pipelines with other passes in the place of some, or none."""
    for pipeline in pipelines:
        passes = [(steps.get(step, step), text) for step, text in pipeline.passes]
        pipeline.passes = [(step, text) for step, text in passes if step]
        pipeline._finalized = False
        pipeline.finalize()
    return pipelines
