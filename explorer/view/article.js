// The article: each of its scenes is a motion, one slider, a clock, and the picture of the disk on its table.
//
// What the scenes are is declared in scenes.js, and their prose stands in article.html. A scene moves only while it
// is in view, and of its own accord only where the reader does not mind.

import { onDrag } from "./controls.js";
import { clockAt } from "./film.js";
import { colourSides, fit, readLook, watch } from "./look.js";
import { CLOCK, stateAt, turningState } from "./physics.js";
import { Player, mayMove } from "./player.js";
import { Ruler } from "./ruler.js";
import { Scene } from "./scene.js";
import { HALF_RACE, SCENES, slowed } from "./scenes.js";
import { Store } from "./state.js";

const COMMON = { disk: "uniform", sigma3_bar: 0, phidot: 1, eta_hat: 0 };
const CAMERA = { azimuth: 0.32, elevation: 0.5 };
// All of a motion, from upright to upright again: the coin lies flat at x = -1.
const AIM = { x: -0.95, y: 0, z: 0.45, radius: 2.45 }, TABLE = { x: -0.95, y: 0, radius: 1.75 };
const RISEN = 1.05; // rad of tilt at which a disk that has risen is shown
const PARTS = `<span class="slowed"></span><canvas class="picture" role="img"></canvas><canvas class="plot" aria-hidden="true"></canvas>
  <div class="handle"><button type="button" class="play"></button>
  <div class="slide"><span></span> <output></output><input type="range"></div></div><figcaption></figcaption>`;

/** A scene of the article as it stands on the page. */
class Figure {
  constructor(declared, section, bodies) {
    this.declared = declared;
    this.element = section.querySelector("figure");
    this.element.innerHTML = PARTS;
    const part = (name) => this.element.querySelector(name);
    [this.canvas, this.plot, this.play, this.slider] = [".picture", ".plot", ".play", "input"].map(part);
    [this.value, this.words, this.slowed] = ["output", "figcaption", ".slowed"].map(part);
    part(".slide span").textContent = declared.slider;
    this.slider.setAttribute("aria-label", declared.slider);
    this.canvas.setAttribute("aria-label", declared.shows);
    const [min, max, step, value] = declared.range;
    Object.assign(this.slider, { min, max, step, value });
    this.slider.classList.toggle("sides", Boolean(declared.sides));
    this.play.innerHTML = document.getElementById("play").innerHTML;
    this.play.hidden = Boolean(declared.posed);
    this.plot.hidden = !declared.plot;

    this.store = new Store({ ...COMMON, ...declared.start, ...declared.changes?.(value) }, bodies, 1);
    this.player = new Player(this.store, !declared.posed && mayMove());
    this.scene = new Scene(this.canvas, { aim: { ...AIM, ...declared.aim }, table: { ...TABLE, ...declared.table } });
    Object.assign(this.scene.camera, CAMERA, declared.camera);
    this.ruler = declared.plot && new Ruler(this.plot, declared.plot);
    this.store.listen(() => this.load());
    this.load();
    if (!this.player.running) this.player.seek(this.moment());

    this.slider.addEventListener("input", () => this.slid());
    this.play.addEventListener("click", () => { this.player.toggle(); this.stale = true; });
    let from = null; // where a drag began, and the value then: steps of a hand are smaller than those of the slider
    const drag = (x) => {
      this.slider.value = from.value + ((max - min) * (x - from.x)) / this.canvas.clientWidth;
      this.slid();
    };
    onDrag(this.canvas, drag, (x) => { from = { x, value: Number(this.slider.value) }; });
    this.element.addEventListener("pointerdown", () => { this.held = true; });
    for (const kind of ["pointerup", "pointercancel"]) addEventListener(kind, () => { this.held = false; });
    watch(this.element, (visible) => { this.visible = visible; });
  }

  /** The motion is new, or the colours are. A coin that is posed has no race. */
  load() {
    const { store, declared } = this;
    const look = readLook(declared.plain ? 0 : store.shown.eta_hat);
    this.look = { ...look, hand: !declared.bare, trail: !declared.bare };
    colourSides(this.element, this.look);
    this.both = declared.both && store.shown.eta_hat !== 0;
    const paths = [store.main, ...(this.both ? [store.other] : [])];
    this.scene.load(paths, store.body.inner, [declared.posed ? {} : store.numbers, this.both ? store.otherNumbers : {}]);
    this.ruler?.load(store);
    this.stale = true;
  }

  /** The slider sets the motion, and what plays goes on; or it sets the clock, which then rests there. */
  slid() {
    const { declared, player, store } = this;
    if (declared.changes) store.set(declared.changes(Number(this.slider.value)));
    else player.running = false;
    player.seek(this.moment());
    this.stale = true;
  }

  /** The clock at which a motion is shown while the slider moves. */
  moment() {
    const { declared, player, store } = this, { main } = store;
    if (declared.span) return this.spanned(Number(this.slider.value));
    if (declared.posed || (player.running && (declared.rest === "start" || !main.turns.length))) return 0;
    if (!main.turns.length) return player.end;
    const flat = turningState(main, 0)[CLOCK];
    return declared.rest === "flat" ? flat : clockAt(main, RISEN, flat, player.end);
  }

  /** The clock at a share of the span that the slider moves through. */
  spanned(share) {
    const [from, to] = this.declared.span(this.store.main);
    return from + share * (to - from);
  }

  advance(seconds) {
    if (!this.visible) return;
    const { player, declared } = this;
    if (!this.held) player.advance(seconds); // a slider that is held does not run away
    if (declared.span && player.running) {
      const from = this.spanned(0), to = this.spanned(1);
      if (player.clock < from || player.clock >= to) player.seek(from);
      this.slider.value = (player.clock - from) / (to - from);
    }
    const resized = fit(this.canvas) + fit(this.plot);
    if (player.running || this.stale || resized) this.draw();
  }

  draw() {
    this.stale = false;
    const { store, player, look, declared } = this;
    this.state = stateAt(store.main, CLOCK, player.clock);
    const parted = this.both && player.clock > turningState(store.main, 0)[CLOCK] - 0.5 * HALF_RACE;
    const other = parted ? stateAt(store.other, CLOCK, player.clock) : null; // until the race both are one
    [this.race] = this.scene.draw([this.state, other], look);
    this.ruler?.draw(this.state, look);
    this.value.textContent = declared.value(this);
    this.words.textContent = declared.says(this);
    this.slowed.textContent = declared.posed ? "" : slowed(this.state);
    this.slider.setAttribute("aria-valuetext", `${this.value.textContent}. ${this.words.textContent}`);
    this.play.classList.toggle("playing", player.running);
    this.play.setAttribute("aria-label", player.running ? "Pause" : "Play");
  }
}

/** All scenes, each in the section that has its name. */
export class Article {
  constructor(bodies) {
    this.figures = SCENES.map((declared) => new Figure(declared, document.getElementById(declared.name), bodies));
  }

  /** Colours or sizes may have changed. */
  load() {
    this.figures.forEach((figure) => figure.load());
  }

  advance(seconds) {
    this.figures.forEach((figure) => figure.advance(seconds));
  }
}
