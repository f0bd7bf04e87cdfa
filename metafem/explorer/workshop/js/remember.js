// What the browser keeps beyond a tab: how the page looks. A store of the tab keeps what it has not sent.

// A full or forbidden store forgets, and nothing else.
export function remember(key, text, store = localStorage) {
  try {
    store.setItem(key, text);
  } catch (error) {
    console.info(`${key} cannot be kept by the browser: ${error.message}`);
  }
}
