// What tests and benchmarks evaluate in a page of the explorer.

window.probe = {
  // An answer to this event comes after the server has begun with all events before. A step that waited in the
  // browser behind an answer is sent when that has been drawn, so that rest is what so many rounds agree on.
  taken: () => socket.timeout(30000).emitWithAck(
    'ack', { client_id: clientId, next_message_id: nextMessageId }),

  // The number of the last step of the history, and whether both pictures show its answer, no longer search follows, and
  // no drag waits for the answer that decides where it ends.
  settled: before => {
    const asked = Number(document.querySelector('[data-asked]')?.dataset.asked ?? 0);
    const shown = [...document.querySelectorAll('[data-answered]')].filter(each => each.checkVisibility());
    const searched = document.querySelector('.law-refusal')?.textContent.includes('A longer search follows');
    return asked > before && shown.length > 0 && !searched && shown.every(each => Number(each.dataset.answered) >= asked);
  },

  // Types a text into a field and leaves it.
  typed: ([key, text]) => {
    const field = document.querySelector(`.fields input[data-key="${key}"]`);
    if (!field) return; // gone with the kind of a section
    field.focus();
    field.value = text;
    field.dispatchEvent(new Event('input', { bubbles: true }));
    field.dispatchEvent(new Event('change', { bubbles: true }));
  },

  // Times of pointer moves and of the last release, and of the frames after which the answers are on the screen.
  watch: () => {
    const seen = { moves: [], drawn: [], sent: 0 };
    const emit = socket.emit;
    socket.emit = function (...given) { seen.sent += given[0] === 'event'; return emit.apply(this, given); };
    addEventListener('pointermove', () => seen.moves.push(performance.now()), true);
    const all = () => [...document.querySelectorAll('[data-answered]')];
    const shown = () => all().filter(each => each.checkVisibility());
    let last = '';
    new MutationObserver(() => {
      const numbers = new Set(shown().map(each => each.dataset.answered));
      const [number] = numbers;
      if (numbers.size !== 1 || number === last) return;
      last = number;
      requestAnimationFrame(() => requestAnimationFrame(() => seen.drawn.push(performance.now())));
    }).observe(document.body, { subtree: true, attributes: true, attributeFilter: ['data-answered'] });
    window.seen = seen;
  },

  // Whether a move has been answered, or has asked for nothing: the handle stays where it can go no further.
  drawn: ([drawn, sent]) => seen.drawn.length > drawn
    || (seen.sent === sent && performance.now() > seen.moves.at(-1) + 200),
};
