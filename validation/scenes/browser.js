// What is evaluated in a page to judge it.

window.probe = {
  // Height and overflow of the page, pictures without a size, anchors that stand twice, and colours of text and
  // ground.
  measure: () => {
    const seen = each => each.checkVisibility();
    const size = each => { const box = each.getBoundingClientRect(); return Math.min(box.width, box.height); };
    const ids = [...document.querySelectorAll('[id]')].map(each => each.id);
    const tone = text => text.match(/[\d.]+/g).slice(0, 3).reduce((sum, each) => sum + Number(each), 0) / 765;
    const style = getComputedStyle(document.body);
    return {
      tall: document.documentElement.scrollHeight,
      overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
      empty: [...document.querySelectorAll('img, svg')].filter(seen).filter(each => size(each) < 5).length,
      broken: [...document.images].filter(each => !each.complete || each.naturalWidth === 0).length,
      repeated: ids.filter((each, i) => ids.indexOf(each) !== i),
      ink: tone(style.color), ground: tone(style.backgroundColor),
    };
  },

  links: () => [...new Set([...document.querySelectorAll('a[href]')].map(each => each.getAttribute('href')))],
};
