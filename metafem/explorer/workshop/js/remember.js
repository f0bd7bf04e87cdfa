// What the browser keeps beyond a tab: how the page looks.

// A full or forbidden store forgets, and nothing else.
export function remember(key, text) {
  try {
    localStorage.setItem(key, text);
  } catch (error) {
    console.info(`${key} cannot be kept by the browser: ${error.message}`);
  }
}
