// The page: one store, one clock, and everything that draws.

import { bindCamera, bindControls, bindMaps, onArrows, onDrag, showControls } from "./controls.js";
import { ConstantsPlane, Portrait } from "./planes.js";
import { CLOCK, T, stateAt } from "./physics.js";
import { Gauge, showNow, showNumbers } from "./readouts.js";
import { bindSaving } from "./saving.js";
import { Scene } from "./scene.js";
import { Store, readHash, writeHash } from "./state.js";
import { TimePlot } from "./timeplot.js";

const $ = (id) => document.getElementById(id);
const REST = 1.4; // s between the end of the motion and the next beginning
const SETTLING = 1500; // ms after a change for which a page that stands still is drawn: the camera settles
const LONGEST_FRAME = 0.1; // s that a frame may stand for, so that a hidden page does not jump

/** Colours as the style sheet has them now; `sides` and `sideColours` are [shown, other]. */
function readLook(shown) {
  const style = getComputedStyle(document.documentElement);
  const css = (name) => style.getPropertyValue(`--${name}`).trim();
  const rgb = (name) => css(name).match(/[0-9a-f]{2}/gi).map((pair) => parseInt(pair, 16));
  const order = shown.eta_hat > 0 ? ["plus", "minus"] : shown.eta_hat < 0 ? ["minus", "plus"] : ["ink", "ink"];
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const tint = (name) => `rgba(${rgb(name).join(",")}, ${dark ? 0.22 : 0.13})`;
  return {
    plus: css("plus"), minus: css("minus"),
    ink: css("ink"), soft: css("soft"), paper: css("panel"), panel: css("panel"), grid: css("grid"), axis: css("rule"),
    level: css("level"), table: css("table"), tableFar: css("table-far"), tableEdge: css("table-edge"), tableLine: css("table-line"),
    faceUp: rgb("face-up"), faceDown: rgb("face-down"), markUp: css("mark-up"), markDown: css("mark-down"), ground: rgb("table"),
    sides: order.map(rgb), sideColours: order.map(css), sideInks: order.map((name) => css(`${name}-ink`) || css(name)),
    plusInk: css("plus-ink"), minusInk: css("minus-ink"), tints: { 1: tint("plus"), [-1]: tint("minus") },
    shadow: dark ? 1.2 : 1,
  };
}

class Player {
  constructor(store) {
    this.store = store;
    this.clock = 0;
    this.rest = 0;
    this.running = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!this.running) this.clock = this.afterRace();
  }

  /** A little after the first race: what a page shows that must not move. */
  afterRace() {
    const { states, turns } = this.store.main;
    return turns.length ? states[turns[0]][CLOCK] + 1.2 : 0;
  }

  get end() {
    const { states } = this.store.main;
    return states[states.length - 1][CLOCK];
  }

  toggle() {
    if (!this.running && this.clock >= this.end) this.clock = 0;
    this.running = !this.running;
    this.rest = 0;
  }

  restart() {
    this.clock = this.rest = 0;
  }

  seek(clock) {
    this.clock = Math.min(this.end, Math.max(0, clock));
    this.rest = 0;
  }

  /** Let `seconds` go by; without `slow` real time runs and a race is over in an instant. */
  advance(seconds) {
    if (!this.running) return;
    const { shown, main } = this.store;
    const step = shown.pace * seconds;
    if (this.clock >= this.end) {
      this.rest += seconds;
      if (this.rest > REST) this.restart();
    } else if (shown.slow) this.clock = Math.min(this.end, this.clock + step);
    else {
      const t = stateAt(main, CLOCK, this.clock)[T] + step;
      const { states } = main;
      this.clock = t >= states[states.length - 1][T] ? this.end : stateAt(main, T, t)[CLOCK];
    }
  }
}

class Page {
  constructor(data) {
    this.store = new Store({ ...data.start, ...readHash(location.hash) }, data.bodies);
    this.player = new Player(this.store);
    this.scene = new Scene($("scene"), !this.player.running);
    this.times = new TimePlot($("times"));
    this.plane = new ConstantsPlane($("plane"));
    this.portrait = new Portrait($("portrait"));
    this.gauge = new Gauge($("gauge"));
    this.canvases = ["scene", "times", "plane", "portrait", "gauge"].map($);
    this.frame = { count: 0, milliseconds: 0 };
    this.visible = true;
    this.touch = () => { this.restless = performance.now() + SETTLING; };
    this.store.listen((moved) => this.changed(moved));
    bindControls(this.store, this.player);
    bindCamera($("scene"), this.scene.camera, this.touch);
    bindMaps(this.store, this.plane, this.portrait);
    bindSaving(this.store);
    const seek = (clock) => { this.player.seek(clock); this.touch(); };
    onDrag($("times"), (x) => seek(this.times.clockAt(x)), () => { this.player.running = false; });
    onArrows($("times"), (dx, dy) => seek(this.player.clock + 0.05 * dx + 0.5 * dy));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.changed(true));
    addEventListener("hashchange", () => this.store.set(readHash(location.hash)));
    // Pages in a notebook that are scrolled away rest.
    new IntersectionObserver((seen) => { this.visible = seen.some((entry) => entry.isIntersecting); }).observe(document.body);
    for (const kind of ["resize", "pointerdown", "keydown"]) addEventListener(kind, this.touch);
    this.changed(true);
  }

  /** Something was set. Pictures that stand still are drawn anew, the address follows. */
  changed(moved) {
    const { store } = this;
    this.look = readLook(store.shown);
    showControls(store, this.look);
    this.plane.load(store.shown, store.body);
    this.gauge.load(store);
    if (moved) {
      const paths = [store.main, store.other];
      this.scene.load(paths, store.body.inner ?? 0, [store.numbers, store.otherNumbers]);
      this.times.load(paths, store.numbers);
      this.portrait.load(store.shown, paths);
      showNumbers(store);
      this.player.clock = Math.min(this.player.clock, this.player.end);
    }
    this.written = false;
    this.touch();
  }

  /** The address carries the view; not at every step of a drag, which browsers refuse. */
  writeAddress() {
    if (this.written) return;
    this.written = true;
    const hash = writeHash(this.store.shown);
    try {
      if (hash !== location.hash) history.replaceState(null, "", hash);
    } catch {
      // A page inside a notebook has no address of its own.
    }
  }

  fitCanvases() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    for (const canvas of this.canvases) {
      const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
      if (canvas.width === width && canvas.height === height) continue;
      canvas.width = width;
      canvas.height = height;
      for (const plot of [this.times, this.plane, this.portrait, this.gauge]) plot.chart.stale = true;
    }
  }

  draw() {
    const { store, player, look } = this;
    this.fitCanvases();
    const main = stateAt(store.main, CLOCK, player.clock);
    const both = store.shown.ghost && store.shown.eta_hat;
    const other = both ? stateAt(store.other, CLOCK, player.clock) : null;
    const states = [main, other];
    const races = this.scene.draw(states, look);
    this.times.draw(states, look);
    this.plane.draw(look);
    this.portrait.draw(states, look);
    this.gauge.draw(look);
    showNow(main, store.shown.face, races);
    document.body.classList.toggle("playing", player.running);
  }

  timedDraw() {
    const begun = performance.now();
    this.draw();
    this.frame.milliseconds += performance.now() - begun;
    this.frame.count += 1;
  }

  run() {
    let last = performance.now();
    let written = last;
    const tick = (now) => {
      // First of all: whatever goes wrong in one frame, the next one comes.
      requestAnimationFrame(tick);
      this.player.advance(Math.min(LONGEST_FRAME, (now - last) / 1000));
      last = now;
      if (this.visible && (this.player.running || now < this.restless)) this.timedDraw();
      if (now - written > 400) {
        this.writeAddress();
        written = now;
      }
    };
    requestAnimationFrame(tick);
  }
}

const data = JSON.parse($("start").textContent);
$("note").textContent = data.note && ` · ${data.note}`;
const page = new Page(data);
page.run();
window.nearflat = page;
