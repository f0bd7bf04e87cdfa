"""Tables of refusals: a call, and the key and the value that the message must hold."""

import metafem as mf
from metafem.errors import spoken


def faults(rows):
    """Return key, value and message of each call that is not refused, or not by a message that holds both."""
    found = []
    for call, key, value in rows:
        said = "nothing"
        try:
            call()
        except mf.InvalidInput as error:
            said = str(error)
            if spoken(key) in said and value in said:
                continue
        found.append((key, value, said))
    return found
