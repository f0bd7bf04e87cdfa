from .dataset import Summary as Summary
from .made import manufacturing as manufacturing
from .misalignment import misalignment as misalignment
from .models import fidelity as fidelity
from .models import interaction as interaction
from .summary import summary as summary
from .uncertainty import uncertainty as uncertainty
