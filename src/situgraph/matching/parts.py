"""Kernels that only other kernels call are lowered, but optimised once, where they end up.

Numba optimises and emits machine code for each function on its own, together with all functions
it calls. In a deep tree of calls the leaves are compiled again for each level; that was three
quarters of the time the matcher took to compile. A part is only brought into LLVM's language; the
entry that links it optimises the whole program, and emits it, once.
"""

from __future__ import annotations

import gc
from functools import cache
from typing import Any

from llvmlite.binding import Linkage  # type: ignore[import-untyped]
from numba.core import cgutils, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import register_pass
from numba.core.lowering import Lower
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
    LiteralPropagationSubPipelinePass,
    LiteralUnroll,
    MakeFunctionToJitFunction,
    RewriteDynamicRaises,
    RewriteSemanticConstants,
    WithLifting,
)


class PartLibrary(JITCodeLibrary):
    """A library to link, never to run: no optimisation, no machine code, no environment."""

    _shared_module: Any

    def _optimize_functions(self, module: Any) -> None:
        """Not here either; what is linked must agree on how data lies in memory."""
        module.data_layout = self._codegen._data_layout

    def finalize(self) -> None:
        """Nothing is linked yet: else what is deep in the tree would be copied at every level."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """The part and all that it calls, each once."""
        if self._shared_module is None:
            self._shared_module = module = self._own_module()
            for library in self._called():
                part = isinstance(library, PartLibrary)
                other = library._own_module() if part else library._get_module_for_linking()
                module.link_in(other, preserve=True)
        return self._shared_module

    def _own_module(self) -> Any:
        """A copy of the part without what it calls, that may be linked several times."""
        module = self._final_module.clone()
        for function in module.functions:
            if not function.is_declaration and function.linkage == Linkage.external:
                function.linkage = Linkage.linkonce_odr
        return module

    def _called(self) -> list[Any]:
        """The libraries it calls, those that they call, and so on."""
        found = dict.fromkeys(self._linking_libraries)
        for library in (waiting := list(found)):
            if isinstance(library, PartLibrary):
                more = [one for one in library._linking_libraries if one not in found]
                found.update(dict.fromkeys(more))
                waiting += dict.fromkeys(more)
        return waiting

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


class PartLower(Lower):
    """Lowering without what only a debugger would want."""

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


# Passes for arrays, closures, objects and literals, of which parts have none.
NOT_FOR_PARTS = (
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


class PartCompiler(Compiler):
    """Numba's compiler, but for the last step, and for passes that would find nothing to do."""

    def __init__(self, typingctx: Any, *args: Any) -> None:
        """Arguments as those of numba's."""
        super().__init__(typingctx, *args)
        self.state.typingctx = PartTyping(typingctx)

    def define_pipelines(self) -> Any:
        """The usual passes; lowering replaced."""
        pipelines = super().define_pipelines()
        for pipeline in pipelines:
            pipeline.passes = [
                (LowerPart if step is NativeLowering else step, text)
                for step, text in pipeline.passes
                if step not in NOT_FOR_PARTS
            ]
            pipeline._finalized = False
            pipeline.finalize()
        return pipelines
