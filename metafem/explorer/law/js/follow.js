// What follows a handle of the target that is dragged here, until the next answer: the corners of the target's curve and
// the handles on it. The answer has for each of them the factors of a move: along, across (y for a move in x) and up.
const shifted = ({ x, y }, by, [along, across, up]) => ({ x: x + along * by.x, y: y + across * by.x + up * by.y });

// Returns the curve and the places of the handles that follow, by their ids.
export function followed({ wanted, handles }, held) {
  const placeOf = (id) => handles.find((each) => each.id === id);
  const [from, follows] = [placeOf(held?.id), wanted?.follows[held?.id]];
  if (!from || !follows) return { wanted, places: {} };
  const by = { x: held.x - from.x, y: held.y - from.y };
  const moved = { x: [...wanted.x], y: [...wanted.y] };
  for (const [i, ...factors] of follows.corners) {
    const { x, y } = shifted({ x: wanted.x[i], y: wanted.y[i] }, by, factors);
    [moved.x[i], moved.y[i]] = [x, y];
  }
  return { wanted: moved, places: Object.fromEntries(follows.handles.map(([id, ...factors]) => [id, shifted(placeOf(id), by, factors)])) };
}
