"""From measurements to the model and back: calibration, images, measured laws and surfaces, explanations.

Lengths, areas and forces are in mm, mm^2 and N. `metafem.files` reads tables, images and maps with units.
"""

import lazy_loader

# The stub lists the module of each public name; a name is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
