// What the pictures of law and surface tell each other in the browser. Events:
//   load     { load, moving }   rescaled load [mm²] at which the contacts are shown; `moving` while it is dragged or played
//   entries  { entry, exact }   rescaled load at which each site comes into contact; null while it is not known
//   site     site               the site under the pointer or in focus, or null
const links = new EventTarget();

export function tell(name, detail) { links.dispatchEvent(new CustomEvent(name, { detail })); }

export function hear(name, call, signal) { links.addEventListener(name, (event) => call(event.detail), { signal }); }
