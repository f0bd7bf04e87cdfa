from .fidelity import fidelity as fidelity
from .interaction import interaction as interaction
from .manufacturing import manufacturing as manufacturing
from .misalignment import misalignment as misalignment
from .summaries import Summary as Summary
from .summaries import summary as summary
from .uncertainty import uncertainty as uncertainty
