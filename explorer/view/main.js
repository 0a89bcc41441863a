// The page: one store, one clock, and everything that draws.

import { Article } from "./article.js";
import { bindCamera, bindControls, bindMaps, onArrows, onDrag, showControls } from "./controls.js";
import { fit, readLook, watch } from "./look.js";
import { CLOCK, stateAt } from "./physics.js";
import { ConstantsPlane, Portrait } from "./planes.js";
import { Player, mayMove } from "./player.js";
import { Gauge, showNow, showNumbers } from "./readouts.js";
import { bindSaving } from "./saving.js";
import { Scene } from "./scene.js";
import { Store, readHash, writeHash } from "./state.js";
import { TimePlot } from "./timeplot.js";

const $ = (id) => document.getElementById(id);
const SETTLING = 1500; // ms after a change for which a page that stands still is drawn: the camera settles
const LONGEST_FRAME = 0.1; // s that a frame may stand for, so that a hidden page does not jump

class Page {
  constructor(data) {
    const named = readHash(location.hash);
    this.store = new Store({ ...data.start, ...named }, data.bodies);
    this.player = new Player(this.store, mayMove());
    if (!mayMove()) this.player.seek(this.player.afterRace());
    this.scene = new Scene($("scene"), { still: !mayMove() });
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
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.changed(true);
      this.article?.load();
    });
    addEventListener("hashchange", () => {
      const asked = readHash(location.hash);
      if (Object.keys(asked).length) this.store.set(asked);
    });
    watch($("laboratory"), (visible) => { this.visible = visible; });
    for (const kind of ["resize", "pointerdown", "keydown"]) addEventListener(kind, this.touch);
    $("to-article").addEventListener("click", () => this.showArticle());
    this.changed(true);
    if (!data.laboratory && !Object.keys(named).length) {
      this.showArticle();
      this.written = true; // until something is moved in the laboratory, the address is that of the article
      document.getElementById(location.hash.slice(1))?.scrollIntoView();
    }
  }

  showArticle() {
    $("article").hidden = false;
    this.article ??= new Article(this.store.bodies);
  }

  /** Something was set. Pictures that stand still are drawn anew, the address follows. */
  changed(moved) {
    const { store } = this;
    this.look = readLook(store.shown.eta_hat);
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
    const changed = this.canvases.map(fit).some(Boolean);
    if (changed) for (const plot of [this.times, this.plane, this.portrait, this.gauge]) plot.chart.stale = true;
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
    $("play").classList.toggle("playing", player.running);
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
      const seconds = Math.min(LONGEST_FRAME, (now - last) / 1000);
      last = now;
      this.article?.advance(seconds);
      if (this.visible) this.player.advance(seconds);
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
$("note").textContent = data.note;
document.body.classList.toggle("framed", self !== top);
const page = new Page(data);
page.run();
window.nearflat = page;
