# mypy: disable-error-code="no-untyped-call, misc"
"""How numba compiles functions whose array arguments never overlap: their loops over columns then become vectors."""

from typing import Any

from numba.core.compiler import CompilerBase, DefaultPassBuilder


class Unaliased(CompilerBase):
    """numba's usual compilation, but for what it tells LLVM of the arguments."""

    def define_pipelines(self) -> list[Any]:
        """The usual passes."""
        self.state.flags.noalias = True
        return [DefaultPassBuilder.define_nopython_pipeline(self.state)]
