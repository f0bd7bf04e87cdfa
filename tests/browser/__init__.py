"""Steps of a hand on a page that several tests make."""

# Drops a file onto an element.
DROP = """(place, [name, content]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([new Uint8Array(content)], name));
  place.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
}"""


def after(visit, step, *given, **named):
    """Do a step and wait for its answer."""
    before = visit.asked
    step(*given, **named)
    visit.settled(before)


def drop(visit, where, name, content):
    """Drop a file with some bytes onto an element."""
    visit.page.locator(where).evaluate(DROP, [name, list(content)])


def hold(visit, handle):
    """Press the mouse on a handle, and return where [pixels]."""
    x, y = visit.middle(handle)
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    return x, y


# Whether legend and refusal are read without scrolling.
WHOLE = """() => [...document.querySelectorAll('.law-refusal, .law-legend')]
  .every(each => each.scrollHeight <= each.clientHeight + 2)"""


# Where a site of the map is on the screen.
PLACE = """number => {
  const { placeOf, $refs: { svg } } = getElement(document.querySelector('.surface-view')).$refs.map;
  svg.scrollIntoView({ block: 'nearest' });
  const [x, y] = placeOf(number), box = svg.getBoundingClientRect();
  return [box.x + x, box.y + y];
}"""


def site(visit, number):
    """Return where a site of the map is on the screen [pixels]."""
    return visit.page.evaluate(PLACE, number)


def take(page, step, path):
    """Do a step that downloads a file, and return where it is saved."""
    with page.expect_download() as download:
        step()
    download.value.save_as(path)
    return path
