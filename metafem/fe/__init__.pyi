from .block3d import Block3D as Block3D
from .prescribed_radius import PressedContact as PressedContact
from .prescribed_radius import press as press
