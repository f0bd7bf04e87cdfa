from .axisymmetric.active_set import ActiveSetContact as ActiveSetContact
from .axisymmetric.active_set import search_contact as search_contact
from .axisymmetric.prescribed_radius import PressedContact as PressedContact
from .axisymmetric.press import measure_pedestal as measure_pedestal
from .axisymmetric.press import press as press
from .block3d.substrate import Block3D as Block3D
from .linear_solve import LinearStatus as LinearStatus
