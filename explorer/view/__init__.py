"""The interactive page: the disk rolls in three dimensions, on both sides of F, in any browser.

Importing a file of this room makes `explorer.view` this module, although users know that name as a
function. So the module can be called, and does what the function does.
"""

import sys
from types import ModuleType
from typing import Any


class _Callable(ModuleType):
    def __call__(self, *arguments: Any, **options: Any) -> Any:
        from explorer.view.page import view

        return view(*arguments, **options)


sys.modules[__name__].__class__ = _Callable
