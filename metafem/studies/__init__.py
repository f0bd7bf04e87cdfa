"""Studies of a design as datasets."""

import lazy_loader

# As in metafem, each study is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
