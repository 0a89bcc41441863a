// Buttons, sliders, keys and dragging: everything that changes what is shown.

import { format } from "./chart.js";
import { colourSides } from "./look.js";
import { etaHatToPlace, placeToEtaHat } from "./state.js";

const $ = (id) => document.getElementById(id);
const UPRIGHT = 0.5 * Math.PI;
const TURN = 0.008; // rad of the camera per pixel
const KEY_TURN = 0.08;
const ASIDE = 6; // pixels that a finger goes aside before it drags
const FINGER = 28; // px within which a finger takes hold of a dot

/** The sliders that hold one number as it is. */
const SLIDERS = { s3: "sigma3_bar", phidot: "phidot" };

export function bindControls(store, player) {
  for (const [id, name] of Object.entries(SLIDERS)) {
    $(id).addEventListener("input", () => store.set({ [name]: Number($(id).value) }));
  }
  $("eta").addEventListener("input", () => store.set({ eta_hat: placeToEtaHat(Number($("eta").value)) }));
  $("inner").addEventListener("input", () => store.set({ disk: diskOf(Number($("inner").value), store) }));
  $("pace").addEventListener("input", () => store.set({ pace: 2 ** Number($("pace").value) }));
  for (const id of ["slow", "ghost"]) $(id).addEventListener("change", () => store.set({ [id]: $(id).checked }));
  $("flip").addEventListener("click", () => flip(store));
  $("reset").addEventListener("click", () => { store.reset(); player.restart(); });
  $("play").addEventListener("click", () => player.toggle());
  $("again").addEventListener("click", () => player.restart());
  $("share").addEventListener("click", () => share());
  for (const button of $("faces").children) {
    button.addEventListener("click", () => store.set({ face: Number(button.dataset.face) }));
  }
  for (const body of store.bodies) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = body.label;
    button.dataset.disk = body.name;
    button.addEventListener("click", () => store.set({ disk: body.name }));
    $("bodies").append(button);
  }
  document.addEventListener("keydown", (event) => pressed(event, store, player));
}

/** The named body with this hole, if there is one, or the annulus. */
function diskOf(inner, store) {
  const named = store.bodies.find((body) => body.ring && Math.abs(body.inner - inner) < 0.006);
  return named ? named.name : `annulus:${inner}`;
}

function flip(store) {
  if (store.shown.eta_hat) store.set({ eta_hat: -store.shown.eta_hat });
}

async function share() {
  try {
    await navigator.clipboard.writeText(location.href);
    $("share").textContent = "copied";
  } catch {
    $("share").textContent = "see the address bar";
  }
  setTimeout(() => { $("share").textContent = "copy link"; }, 1500);
}

function pressed(event, store, player) {
  // Whoever reads the article scrolls it with the space bar.
  const reading = $("laboratory").getBoundingClientRect().top > 0.5 * innerHeight;
  if (reading || event.ctrlKey || event.metaKey || event.altKey) return;
  const typing = event.target.matches("input[type=range], button, summary");
  const key = event.key.toLowerCase();
  const actions = {
    f: () => flip(store),
    g: () => store.set({ ghost: !store.shown.ghost }),
    s: () => store.set({ slow: !store.shown.slow }),
    r: () => { store.reset(); player.restart(); },
    home: () => player.restart(),
  };
  if (!typing) actions[" "] = () => player.toggle();
  store.bodies.slice(0, 9).forEach((body, n) => { actions[String(n + 1)] = () => store.set({ disk: body.name }); });
  if (!actions[key] || (typing && key === "home")) return;
  event.preventDefault();
  actions[key]();
}

/** Sliders and buttons as the store says, also when something else moved them. */
export function showControls(store, colours) {
  const { shown, body } = store;
  const onF = !shown.eta_hat;
  colourSides(document.documentElement, colours);
  for (const [id, name] of Object.entries(SLIDERS)) $(id).value = shown[name];
  $("eta").value = etaHatToPlace(shown.eta_hat);
  $("eta-text").textContent = onF ? "0: on F" : format(shown.eta_hat, 3, true);
  const side = onF ? "F itself" : `${shown.eta_hat > 0 ? "blue" : "vermilion"} side of F`;
  $("eta").setAttribute("aria-valuetext", `${format(shown.eta_hat, 3, true)}, ${side}`);
  $("flip").disabled = onF;
  $("s3-text").textContent = format(shown.sigma3_bar, 3);
  $("phidot-text").textContent = format(shown.phidot, 3);
  $("inner").value = body.inner ?? 0;
  $("body-text").textContent = body.label;
  $("pace").value = Math.log2(shown.pace);
  for (const [id, words] of [["s3", format(shown.sigma3_bar, 3)], ["phidot", format(shown.phidot, 3)],
    ["inner", body.label], ["pace", `${format(shown.pace, 2)} times`]]) $(id).setAttribute("aria-valuetext", words);
  for (const id of ["slow", "ghost"]) $(id).checked = shown[id];
  for (const button of $("faces").children) button.setAttribute("aria-pressed", Number(button.dataset.face) === shown.face);
  for (const button of $("bodies").children) button.setAttribute("aria-pressed", button.dataset.disk === shown.disk);
  $("kappa").textContent = `here ${(body.kappa / 2).toFixed(2)} turns`;
  const here = format(shown.eta_hat, 2, true);
  $("side-name").textContent = onF ? "on F" : `one side of F: η̂ = ${here}`;
  $("other-name").textContent = `the other side: η̂ = ${format(-shown.eta_hat, 2, true)}`;
  $("other-name").parentElement.hidden = !shown.ghost || onF;
}

/**
 * Calls `move(x, y, event)` while the canvas is dragged. A finger that goes up or down scrolls the page instead, but
 * where it `grabs(x, y)` something.
 */
export function onDrag(canvas, move, begin = () => {}, grabs = () => false) {
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  let from = null; // where a finger was set down that has not moved aside yet
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    begin(...place(event), event);
    from = event.pointerType === "touch" && event.isPrimary && !grabs(...place(event)) ? place(event) : null;
    if (!from) move(...place(event), event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const [x, y] = place(event);
    if (from && Math.abs(x - from[0]) <= Math.max(ASIDE, Math.abs(y - from[1]))) return;
    from = null;
    if (canvas.hasPointerCapture(event.pointerId)) move(x, y, event);
  });
  canvas.addEventListener("touchstart", (event) => {
    if (grabs(...place(event.touches[0]))) event.preventDefault(); // or the browser scrolls
  }, { passive: false });
}

/** Dragging turns the camera, two fingers or the wheel with Ctrl zoom (the wheel alone scrolls), arrow keys do both. */
export function bindCamera(canvas, camera, drawn) {
  const fingers = new Map();
  let spread = 0;
  const gone = (event) => fingers.delete(event.pointerId);
  canvas.addEventListener("pointerup", gone);
  canvas.addEventListener("pointercancel", gone);
  onDrag(canvas, (x, y, event) => {
    const before = fingers.get(event.pointerId) ?? [x, y];
    fingers.set(event.pointerId, [x, y]);
    if (fingers.size === 1) camera.turn(-TURN * (x - before[0]), TURN * (y - before[1]));
    if (fingers.size === 2) {
      const [a, b] = [...fingers.values()];
      const now = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (spread > 0) camera.magnify(now / spread);
      spread = now;
    } else spread = 0;
    drawn();
  });
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    camera.magnify(Math.exp(-0.0012 * event.deltaY));
    drawn();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => { camera.home(); drawn(); });
  onArrows(canvas, (dx, dy) => { camera.turn(KEY_TURN * dx, KEY_TURN * dy); drawn(); });
  canvas.addEventListener("keydown", (event) => {
    if (event.key === "+" || event.key === "=") camera.magnify(1.1);
    else if (event.key === "-") camera.magnify(1 / 1.1);
    else return;
    drawn();
  });
}

/** Calls `move(dx, dy)` for arrow keys on a canvas that has the focus; y upwards. */
export function onArrows(canvas, move) {
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  canvas.addEventListener("keydown", (event) => {
    if (!steps[event.key]) return;
    event.preventDefault();
    move(...steps[event.key]);
  });
}

/** Dragging and arrow keys on both maps change the start. */
export function bindMaps(store, plane, portrait) {
  const on = (map, name) => {
    const drag = (x, y) => store.set(map.drag(x, y));
    const start = () => (name === "plane" ? map.place(store.shown.eta_hat) : map.startPixel());
    onDrag($(name), drag, undefined, (x, y) => Math.hypot(x - start()[0], y - start()[1]) < FINGER);
    onArrows($(name), (dx, dy) => {
      const [x, y] = start();
      drag(x + 2 * dx, y - 2 * dy);
    });
  };
  on(plane, "plane");
  on(portrait, "portrait");
  $("portrait").addEventListener("dblclick", () => store.set({ theta: UPRIGHT, phidot: 1 }));
}
