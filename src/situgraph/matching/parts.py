"""Kernels that only other kernels call are lowered, but optimised once, where they end up.

Numba optimises and emits machine code for each function on its own, together with all functions
it calls. In a deep tree of calls the leaves are compiled again for each level; that was three
quarters of the time the matcher took to compile. A part is only brought into LLVM's language; the
entry that links it optimises the whole program, and emits it, once.
"""

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import InlineOverloads, NativeLowering, NopythonRewrites
from numba.core.untyped_passes import InlineClosureLikes


class PartLibrary(JITCodeLibrary):
    """A library to link, never to run: no optimisation, no machine code, no environment."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
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


@register_pass(mutates_CFG=True, analysis_only=False)
class LowerPart(NativeLowering):
    """Lowering into a library that is only linked."""

    _name = "lower_part"

    def run_pass(self, state: Any) -> bool:
        """Lower one function."""
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return bool(super().run_pass(state))


# Passes for expressions on arrays, comprehensions and overloads, of which parts have none.
NOT_FOR_PARTS = (InlineClosureLikes, InlineOverloads, NopythonRewrites)


class PartCompiler(Compiler):
    """Numba's compiler, but for the last step, and for passes that would find nothing to do."""

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
