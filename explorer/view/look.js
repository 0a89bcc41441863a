// Colours as the style sheet has them now, canvases as fine as the screen, and what of them is in view.

/** The colours of pictures and plots; `sides` and `sideColours` are [shown, other] for the side of F, or 0. */
export function readLook(side) {
  const style = getComputedStyle(document.documentElement);
  const css = (name) => style.getPropertyValue(`--${name}`).trim();
  const rgb = (name) => css(name).match(/[0-9a-f]{2}/gi).map((pair) => parseInt(pair, 16));
  const order = side > 0 ? ["plus", "minus"] : side < 0 ? ["minus", "plus"] : ["ink", "ink"];
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const tint = (name) => `rgba(${rgb(name).join(",")}, ${dark ? 0.22 : 0.13})`;
  return {
    plus: css("plus"), minus: css("minus"),
    ink: css("ink"), soft: css("soft"), paper: css("panel"), panel: css("panel"), grid: css("grid"), axis: css("rule"),
    level: css("level"), table: css("table"), tableFar: css("table-far"), tableEdge: css("table-edge"), tableLine: css("table-line"),
    faceUp: rgb("face-up"), faceDown: rgb("face-down"), markUp: css("mark-up"), markDown: css("mark-down"), ground: rgb("table"),
    sides: order.map(rgb), sideColours: order.map(css), sideInks: order.map((name) => css(`${name}-ink`) || css(name)),
    plusInk: css("plus-ink"), minusInk: css("minus-ink"), tints: { 1: tint("plus"), [-1]: tint("minus") },
    shadow: dark ? 1.2 : 1, hand: true, trail: true,
  };
}

/** Gives what lies in `element` the colours of the sides: of the shown motion and of the other. */
export function colourSides(element, look) {
  ["shown", "hidden"].forEach((name, n) => {
    element.style.setProperty(`--${name}`, look.sideColours[n]);
    element.style.setProperty(`--${name}-ink`, look.sideInks[n]);
  });
}

/** Gives a canvas as many pixels as its place has; whether that changed it. */
export function fit(canvas) {
  const ratio = Math.min(2, devicePixelRatio || 1);
  const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width === width && canvas.height === height) return false;
  Object.assign(canvas, { width, height });
  return true;
}

/** Calls `tell(visible)` as an element comes into view and goes: what is scrolled away rests. */
export function watch(element, tell) {
  new IntersectionObserver((seen) => tell(seen.some((entry) => entry.isIntersecting))).observe(element);
}
